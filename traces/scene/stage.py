"""The choice of the first eye of a run: everything is in the picture, and the robot hides as little as possible.

The eye is a function of the record: of tables and objects, and of the robot at each decision.
"""

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from skolem.traces.messages import Belief, ObjectType, Pose2, Pose4, TrueState
from skolem.traces.messages.likeliest import likeliest
from skolem.traces.scene.eye import Eye, framing
from skolem.traces.scene.shapes import Xyz, point_on

LIMB_M: Final = 0.16  # radius of a limb around the line from joint to joint
_POINT_M: Final = 0.01  # radius around a corner
_ABOVE_M: Final = 0.3  # height above tables and objects that must be in the picture, for regions and labels
_ALONG_M: Final = 0.2  # largest distance between points on a limb
_STAND_M: Final = 0.9  # distance from the middle of a table, on the near side, at which the robot is expected
_SPOTS: Final = (-0.4, -0.15, 0.15, 0.4)  # positions on a table, in shares of its sides
_SPOT_M: Final = 0.06  # height of objects above the top
_TURNS: Final = 36  # number of directions to look from, for each of these elevations
_ELEVATIONS: Final = tuple(map(math.radians, (30.0, 36.0, 42.0)))
_HIDDEN: Final = 2.0  # costs of an eye: for the share of the tables that the robot hides, mean over its poses,
_COVERED: Final = 0.4  # for the share of the robot that tables hide,
_FAR: Final = 0.3  # for twice the distance of the nearest eye,
_ASIDE: Final = 0.05  # and for a robot seen from the side at its start; from the back it is twice that
_POSES: Final = 24  # most poses for which hidden parts are computed, evenly spread over the decisions
_DIGITS: Final = 6  # of costs: smaller differences are rounding errors, and the first eye is taken
Array = NDArray[np.float64]
Limb = tuple[Xyz, Xyz]


@dataclass(frozen=True, slots=True)
class _Table:
    """A table: its top in the world, and its size [m]."""

    world_T_table: Pose4
    size_m: Xyz

    def spots(self) -> list[Xyz]:
        """Return positions of objects on it, world frame [m]."""
        x, y, z = self.size_m
        return [point_on(self.world_T_table, (i * x, j * y, z + _SPOT_M)) for i in _SPOTS for j in _SPOTS]

    def covers(self, eye: Xyz, points: Array) -> NDArray[np.bool_]:
        """Return which points, shape (n, 3), the top hides from an eye above it, shape (n,)."""
        x, y, z, theta = self.world_T_table
        above, below = eye[2] - z - self.size_m[2], z + self.size_m[2] - points[:, 2]
        share = above / np.maximum(above + below, 1e-9)
        dx, dy = (eye[i] + share * (points[:, i] - eye[i]) - (x, y)[i] for i in (0, 1))
        along, across = math.cos(theta) * dx + math.sin(theta) * dy, math.cos(theta) * dy - math.sin(theta) * dx
        inside = (np.abs(along) <= self.size_m[0] / 2.0) & (np.abs(across) <= self.size_m[1] / 2.0)
        return np.asarray(inside & (below > 0.0))


class Stage:
    """Collects the parts of a run that must be in the picture."""

    def __init__(self, limbs: Callable[[Belief], Iterable[Limb]]) -> None:
        """Start with an empty stage.

        Args:
            limbs: Returns start and end of each limb of the believed robot, world frame [m].
        """
        self._limbs = limbs
        self._truth: TrueState | None = None
        self._robots: list[Array] = []
        self._start: Pose2 | None = None
        self._tables: dict[str, _Table] = {}
        self._corners: dict[Xyz, None] = {}

    def state(self, state: TrueState, types: Mapping[str, ObjectType]) -> None:
        """Take in the true poses of all objects."""
        self._truth = state
        for item in state.objects:
            if item.type in types:
                self._put(item.id, item.world_T_object, types[item.type])

    def believed(self, belief: Belief, types: Mapping[str, ObjectType]) -> None:
        """Take in a belief: the robot's posture, and the poses of objects whose truth is not recorded."""
        if self._truth is None:
            for anchor in belief.anchors:
                known = belief.objects[anchor]
                self._put(anchor, known.world_T_object, types[likeliest(known.type)])
        elif self._truth.step == belief.step:
            belief = belief.model_copy(update={"world_T_base": self._truth.world_T_base})
        self._robots.append(_along(self._limbs(belief)))
        self._start = self._start or belief.world_T_base

    def _put(self, name: str, world_T_object: Pose4, kind: ObjectType) -> None:
        x, y, z = kind.size_m
        if kind.shape == "table":
            self._tables[name] = _Table(world_T_object, kind.size_m)
        for corner in itertools.product((-x / 2.0, x / 2.0), (-y / 2.0, y / 2.0), (0.0, z + _ABOVE_M)):
            self._corners[point_on(world_T_object, corner)] = None

    def eye(self, going_on: bool = False) -> Eye | None:
        """Return the eye; None if there is no robot yet.

        Args:
            going_on: Whether the run goes on: then the robot is expected before each table.
        """
        if self._start is None:
            return None
        robots = [*self._robots, *(self._expected() if going_on else ())]
        corners = np.array([*self._corners], np.float64).reshape(-1, 3)
        balls = [(corners, _POINT_M), *((robot, LIMB_M) for robot in robots)]
        everything = np.vstack([np.column_stack((middles, np.full(len(middles), r))) for middles, r in balls])
        sides = [2.0 * math.pi * turn / _TURNS for turn in range(_TURNS)]
        eyes = [(framing(everything, self._start[2] + side, up), side) for side in sides for up in _ELEVATIONS]
        nearest = min(math.dist(eye.at, eye.target) for eye, _ in eyes)
        tables, spots = list(self._tables.values()), [spot for table in self._tables.values() for spot in table.spots()]
        some = robots[:: math.ceil(len(robots) / _POSES)]
        costs = [
            _HIDDEN * _mean(_hidden(eye.at, robot, spots) for robot in some)
            + _COVERED * _mean(_covered(eye.at, robot, tables) for robot in some)
            + _FAR * (math.dist(eye.at, eye.target) / nearest - 1.0)
            + _ASIDE * (1.0 - math.cos(side))
            for eye, side in eyes
        ]
        best, _ = eyes[int(np.argmin(np.round(costs, _DIGITS)))]
        return best

    def _expected(self) -> Iterator[Array]:
        """Yield the present robot, moved to the near side of each table."""
        assert self._start is not None, "there is a robot"
        base = np.array((*self._start[:2], 0.0))
        for table in self._tables.values():
            away = base - (*table.world_T_table[:2], 0.0)
            far = max(float(np.linalg.norm(away)), _STAND_M)
            yield self._robots[0] + (_STAND_M / far - 1.0) * away


def _mean(shares: Iterable[float]) -> float:
    return math.fsum(found := list(shares)) / len(found)


def _hidden(eye: Xyz, robot: Array, spots: Sequence[Xyz]) -> float:
    """Return the share of spots that a robot, shape (n, 3), hides from an eye."""
    towards, blobs = np.array(spots, np.float64).reshape(-1, 3) - eye, robot - eye
    far = np.sqrt((towards**2).sum(axis=1))
    along = (blobs @ towards.T) / far
    aside = (blobs**2).sum(axis=1)[:, None] - along**2
    hidden = ((aside < LIMB_M**2) & (along < far)).any(axis=0)
    return float(hidden.sum()) / max(1, len(spots))


def _covered(eye: Xyz, robot: Array, tables: Iterable[_Table]) -> float:
    """Return the share of a robot, shape (n, 3), that tables hide from an eye."""
    covered = np.zeros(len(robot), np.bool_)
    for table in tables:
        covered |= table.covers(eye, robot)
    return float(covered.mean())


def _along(limbs: Iterable[Limb]) -> Array:
    """Return points along limbs, rounded to centimetres, each once, shape (n, 3)."""
    found = []
    for start, end in limbs:
        shares = np.linspace(0.0, 1.0, math.ceil(math.dist(start, end) / _ALONG_M) + 1)[:, None]
        found.append(np.round((1.0 - shares) * start + shares * end, 2))
    return np.unique(np.vstack(found), axis=0)

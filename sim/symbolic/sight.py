"""The believed sight of the symbolic robot's camera from any base pose."""

import dataclasses
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from skolem.sim.robot.rotations import rotation
from skolem.sim.space.footprints import collide
from skolem.sim.space.pinhole import Frame
from skolem.sim.symbolic.view import OUTLINE_POINTS, SEEN_SHARE, Solid, camera, cast, fits, head_towards, outline
from skolem.traces.messages import ObjectType, Pose2, Pose4
from skolem.traces.messages.poses import Vector3, compose4, inverse4, raised

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclasses.dataclass(frozen=True, slots=True)
class Thing:
    """What stands in the way of sight: its name, type and pose."""

    name: str
    type: ObjectType
    world_T_object: Pose4


class BelievedSight:
    """A camera at one base pose among believed objects; it satisfies `surveys.Camera`."""

    def __init__(self, world_T_base: Pose2, torso: float, things: Sequence[Thing]) -> None:
        """Put the camera among objects."""
        self._world_T_base = raised(world_T_base)
        base_T_world = inverse4(self._world_T_base)
        self._torso = torso
        self._solids = [Solid(thing.name, thing.type, compose4(base_T_world, thing.world_T_object)) for thing in things]
        self._head = (0.0, 0.0)

    def look_at(self, point_world: Vector3) -> tuple[float, float] | None:
        """Turn the camera to a point and return pan and tilt; beyond the limits return None, unturned."""
        point = compose4(inverse4(self._world_T_base), (*point_world, 0.0))[:3]
        head = head_towards(self._torso, np.array(point))
        if head is not None:
            self.turn(head)
        return head

    def turn(self, head: tuple[float, float]) -> None:
        """Turn the camera to a pan and a tilt."""
        self._head = head

    def camera_pose(self) -> tuple[Floats, Floats]:
        """Return the camera's position, shape (3,), and rotation, shape (3, 3), in the world."""
        frame = self._frame()
        x, y, z = frame.origin.tolist()
        return np.array(compose4(self._world_T_base, (x, y, z, 0.0))[:3]), rotation(self._world_T_base[3]) @ frame.axes

    def unhidden(self, points_world: Floats) -> Mask:
        """Return the mask, shape (n,), of points (n, 3), world, that nothing hides."""
        toward = (points_world - self._world_T_base[:3]) @ rotation(self._world_T_base[3]) - self._frame().origin
        return np.asarray(cast(self._frame(), toward, self._solids) > 1.0)

    def hiders(self, name: str, movable: Sequence[str], doubt_m: float = 0.0) -> tuple[str, ...] | None:
        """Turn to an object and return the movable objects that hide it; None if it is too far or others hide it too.

        The object that hides most comes first; one behind it may hide the target too. An object that is believed to
        intersect the target does not hide it: one of the two is elsewhere, and a look shows which.

        Args:
            name: The target.
            movable: The objects that could be taken away.
            doubt_m: How far to either side of its place the target may be; it must be seen wherever it is.
        """
        solid = self._solid(name)
        x, y, z, _ = compose4(self._world_T_base, solid.base_T_solid)
        if self.look_at((x, y, z + solid.type.size_m[2] / 2.0)) is None or not fits(self._frame(), solid):
            return None
        toward = np.concatenate([outline(self._frame().origin, at) for at in self._places(solid, doubt_m)])
        others = [other for other in self._solids if other.id != name and not _are_in_one_another(other, solid)]
        hidden = {o.id: cast(self._frame(), toward - self._frame().origin, [o]) <= 1.0 for o in others}
        gone: tuple[str, ...] = ()
        while True:
            left = [np.zeros(len(toward), dtype=bool), *(hidden[o.id] for o in others if o.id not in gone)]
            seen = ~np.any(left, axis=0).reshape(-1, OUTLINE_POINTS)
            if seen.mean(axis=1).min() >= SEEN_SHARE:
                return gone
            left_over = (n for n in movable if n in hidden and n not in gone)
            most = max(left_over, key=lambda n: int(hidden[n].sum()), default=None)
            if most is None or not hidden[most].any():
                return None
            gone = (*gone, most)

    def _places(self, solid: Solid, doubt_m: float) -> list[Solid]:
        """Return a solid at its place and, if that is in doubt, also to either side of it as seen from here."""
        x, y, z, theta = solid.base_T_solid
        ex, ey, _ = self._frame().origin
        across = np.array([ey - y, x - ex]) / max(math.hypot(x - ex, y - ey), 1e-9) * doubt_m
        shifts = (0.0, -1.0, 1.0) if doubt_m > 0.0 else (0.0,)
        return [
            dataclasses.replace(solid, base_T_solid=(x + k * float(across[0]), y + k * float(across[1]), z, theta))
            for k in shifts
        ]

    def _solid(self, name: str) -> Solid:
        return next(solid for solid in self._solids if solid.id == name)

    def outline(self, name: str) -> Floats:
        """Return points on the outline of an object as seen from here, shape (9, 3), metres, world."""
        points = outline(self._frame().origin, self._solid(name))
        return points @ rotation(self._world_T_base[3]).T + self._world_T_base[:3]

    def _frame(self) -> Frame:
        return camera(self._torso, *self._head)


def _are_in_one_another(a: Solid, b: Solid) -> bool:
    both_things = "table" not in (a.type.shape, b.type.shape)
    return both_things and collide(a.type, a.base_T_solid, b.type, b.base_T_solid)

"""Picks and places: from candidate grasps to complete, collision-free arm motions in the believed world.

A motion is first sketched (inverse kinematics and straight lines, milliseconds) and then joined to the present and the
carry configuration by planned paths. Candidates are tried in a fixed order, and the first feasible one is taken.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from skolem.sim.planner import motion
from skolem.sim.planner.believed import BelievedWorld
from skolem.sim.planner.standing import Carried, Standing
from skolem.sim.robot import ik
from skolem.sim.robot.reach import Reaching, reaching
from skolem.sim.robot.rotations import rotation
from skolem.sim.space import grasps
from skolem.sim.space.room import Disc
from skolem.traces.messages import Hand, Joints7, Pick, Place, Pose4
from skolem.traces.messages.arm import CARRY
from skolem.traces.messages.poses import compose2, compose4, flat, inverse2, inverse4, raised, wrap_half_open

Floats = NDArray[np.float64]

LIFT_M = 0.10
LINE_STEP_M = 0.02
PLACE_YAWS = np.linspace(-1.05, 1.05, 7)
REACH_M = 1.0  # greatest distance of a tried place from the base's middle
PICK_TRIES, PLACE_TRIES = 40, 90  # configurations tried
TRIES_PER_YAW, TRIES_PER_SPOT = 8, 3
TRIES_PER_ROOM = 24  # places with most room lie in the middle of a table, where an arm may never come
JOINED_TRIES = 3  # sketches for which paths are planned
ROOM_STEP_M = 0.04  # places whose room differs by less count as equal
APPROACH_STREAM, CARRY_STREAM = 1, 2
PATH_BUDGET = 2500  # validity checks per path


@dataclass(frozen=True, slots=True)
class PickSketch:
    """The part of a pick near the object; `reach` starts at the pregrasp, `lift` at the grasp."""

    reach: Floats
    lift: Floats
    tool_T_object: Pose4


@dataclass(frozen=True, slots=True)
class PlaceSketch:
    """The part of a place near the table; `lower` starts above the place, `retreat` at the release."""

    lower: Floats
    retreat: Floats
    world_T_object: Pose4


@dataclass(frozen=True, slots=True)
class Spots:
    """Spots for putting an object down: positions (k, 2) in a table's frame, and the room around each, (k,), metres."""

    places: Floats
    room: Floats


class ArmPlanner:
    """Plans arm motions from the pose of the robot in `world`."""

    def __init__(self, world: BelievedWorld, seed: Callable[[int, int], int]) -> None:
        """Keep the world, and the function from (stream, attempt) to a path's seed."""
        self._world = world
        self._seed = seed

    # ---------------------------------------------------------------- pick

    def pick(self, hand: Hand, anchor: str) -> Pick | None:
        """Return the whole pick of a standing object, or None."""
        item = self._world.standing[anchor]
        for attempt, sketch in enumerate(islice(self.pick_sketches(hand, anchor), JOINED_TRIES)):
            approach = self._path(hand, self._world.robot.arm(hand), sketch.reach[0], (APPROACH_STREAM, attempt))
            if approach is None:
                continue
            with self._world.picked(hand, item.anchor, sketch.tool_T_object):
                carry = self._path(hand, sketch.lift[-1], np.array(CARRY[hand]), (CARRY_STREAM, attempt))
            if carry is not None:
                turns = approach[-1] - sketch.reach[0]
                return Pick(
                    hand=hand,
                    approach=waypoints(approach),
                    reach=waypoints(sketch.reach + turns),
                    lift=waypoints(sketch.lift + turns),
                    carry=waypoints(carry + turns),
                    tool_T_object=sketch.tool_T_object,
                )
        return None

    def pick_sketches(self, hand: Hand, anchor: str) -> Iterator[PickSketch]:
        """Yield feasible sketches of picking a standing object, best first."""
        item = self._world.standing[anchor]
        base_T_object = self._in_base(item.world_T_object)
        yaws = grasps.approach_yaws(item.type, base_T_object[3])
        choices = [grasps.grasp(item.type, base_T_object, float(yaw)) for yaw in yaws]
        ranked = self._reaching(hand, [choice.base_T_tool for choice in choices])
        order = np.arange(len(ranked.pose))
        for k in islice(_at_most(TRIES_PER_YAW, order, ranked.pose), PICK_TRIES):
            sketch = self._pick_sketch(hand, item, choices[ranked.pose[k]], ranked.joints[k])
            if sketch is not None:
                yield sketch

    def _pick_sketch(self, hand: Hand, item: Standing, choice: grasps.Grasp, at: Floats) -> PickSketch | None:
        """Return the sketch of a pick that grasps with a configuration; None unless all of it is free."""
        present = self._world.robot.arm(hand)
        try:
            target = frozenset([item.body])
            if not self._free(hand, [at], target):
                return None
            back = self._back(hand, choice.base_T_tool, at, grasps.back_off(item.type, item.spread_m))
            if back is None or not self._free(hand, back[-1:]) or not self._free(hand, back[:-1], target):
                return None
            lift = self._up(hand, choice.base_T_tool, at)
            if lift is None:
                return None
            table = self._table_under(item)
            with self._world.picked(hand, item.anchor, choice.tool_T_object):
                if not self._free(hand, lift, frozenset([table.body] if table else [])):
                    return None
            return PickSketch(np.vstack([back[::-1], [at]]), np.vstack([[at], lift]), choice.tool_T_object)
        finally:
            self._world.set_arm(hand, present)

    def _table_under(self, item: Standing) -> Standing | None:
        """Return the table that is the object's believed support, else the table below it."""
        believed = self._world.standing.get(item.support) if item.support else None
        return believed or self._world.table_below(item)

    # ---------------------------------------------------------------- place

    def place(self, hand: Hand, support: str, spots: Spots) -> Place | None:
        """Return the whole placement of the carried object on one of a table's spots, or None."""
        for attempt, sketch in enumerate(islice(self.place_sketches(hand, support, spots), JOINED_TRIES)):
            approach = self._path(hand, self._world.robot.arm(hand), sketch.lower[0], (APPROACH_STREAM, attempt))
            if approach is None:
                continue
            with self._world.placed(hand, sketch.world_T_object):
                carry = self._path(hand, sketch.retreat[-1], np.array(CARRY[hand]), (CARRY_STREAM, attempt))
            if carry is not None:
                turns = approach[-1] - sketch.lower[0]
                return Place(
                    hand=hand,
                    approach=waypoints(approach),
                    lower=waypoints(sketch.lower + turns),
                    retreat=waypoints(sketch.retreat + turns),
                    carry=waypoints(carry + turns),
                )
        return None

    def place_sketches(self, hand: Hand, support: str, spots: Spots) -> Iterator[PlaceSketch]:
        """Yield feasible sketches of placing the carried object, most room first, easiest configurations first.

        Tries are limited per spot and per level of room, so that they are spread over all of the support in reach.
        """
        table, carried = self._world.standing[support], self._world.carried[hand]
        places, room = self._reachable(table, spots)
        targets = [
            self._tool_above(table, carried, (float(x), float(y)), float(yaw)) for x, y in places for yaw in PLACE_YAWS
        ]
        ranked = self._reaching(hand, targets)
        spot = ranked.pose // len(PLACE_YAWS)
        level = np.floor(room / ROOM_STEP_M).astype(np.intp)[spot]
        order = np.lexsort((np.arange(len(spot)), -level))
        per_spot = np.fromiter(_at_most(TRIES_PER_SPOT, order, spot), dtype=np.intp)
        for k in islice(_at_most(TRIES_PER_ROOM, per_spot, level), PLACE_TRIES):
            sketch = self._place_sketch(hand, table, carried, targets[ranked.pose[k]], ranked.joints[k])
            if sketch is not None:
                yield sketch

    def _reachable(self, table: Standing, spots: Spots) -> tuple[Floats, Floats]:
        """Return the spots within reach, and the room around each."""
        base = compose2(inverse2(flat(table.world_T_object)), self._world.robot.base())
        near = np.hypot(spots.places[:, 0] - base[0], spots.places[:, 1] - base[1]) <= REACH_M
        return spots.places[near], spots.room[near]

    def _tool_above(self, table: Standing, carried: Carried, spot: tuple[float, float], yaw: float) -> Pose4:
        """Return base_T_tool at the release over a spot of the table, with the fingers along `yaw`."""
        top = table.type.size_m[2] + grasps.RELEASE_M
        x, y, z, _ = self._in_base(compose4(table.world_T_object, (spot[0], spot[1], top, 0.0)))
        base_T_object = (x, y, z, wrap_half_open(yaw + carried.tool_T_object[3]))
        return compose4(base_T_object, inverse4(carried.tool_T_object))

    def _place_sketch(
        self, hand: Hand, table: Standing, carried: Carried, base_T_tool: Pose4, at: Floats
    ) -> PlaceSketch | None:
        """Return the sketch of a placement that releases with a configuration; None unless all of it is free."""
        present = self._world.robot.arm(hand)
        try:
            if not self._free(hand, [at]):
                return None
            down = self._up(hand, base_T_tool, at)
            if down is None or not self._free(hand, down):
                return None
            back = self._back(hand, base_T_tool, at, grasps.back_off(carried.type, 0.0))
            if back is None:
                return None
            world_T_object = compose4(raised(self._world.robot.base()), compose4(base_T_tool, carried.tool_T_object))
            with self._world.placed(hand, world_T_object) as body:
                if not self._free(hand, back[:-1], frozenset([body])) or not self._free(hand, back[-1:]):
                    return None
            return PlaceSketch(np.vstack([down[::-1], [at]]), np.vstack([[at], back]), world_T_object)
        finally:
            self._world.set_arm(hand, present)

    # ---------------------------------------------------------------- pieces

    def _in_base(self, world_T_object: Pose4) -> Pose4:
        return compose4(inverse4(raised(self._world.robot.base())), world_T_object)

    def _torso(self) -> float:
        return self._world.robot.state().torso

    def _reaching(self, hand: Hand, base_T_tool: list[Pose4]) -> Reaching:
        return reaching(hand, self._torso(), base_T_tool, np.array(self._world.robot.arm(hand)))

    def _back(self, hand: Hand, base_T_tool: Pose4, at: Floats, distance: float) -> Floats | None:
        """Return configurations along a straight line from the tool pose back against the fingers' direction."""
        ahead = rotation(base_T_tool[3])[:, 0]
        return self._line(hand, base_T_tool, at, -ahead * distance)

    def _up(self, hand: Hand, base_T_tool: Pose4, at: Floats) -> Floats | None:
        """Return configurations along a straight line from the tool pose up."""
        return self._line(hand, base_T_tool, at, np.array([0.0, 0.0, LIFT_M]))

    def _line(self, hand: Hand, base_T_tool: Pose4, at: Floats, along: Floats) -> Floats | None:
        count = math.ceil(float(np.linalg.norm(along)) / LINE_STEP_M)
        share = np.arange(1, count + 1)[:, None] / count
        positions = np.array(base_T_tool[:3]) + share * along
        return ik.follow(hand, self._torso(), at, positions, rotation(base_T_tool[3]))

    def _free(self, hand: Hand, path: Iterable[Floats], touching: frozenset[int] = frozenset()) -> bool:
        """Return whether no configuration of a path collides."""
        for joints in path:
            self._world.set_arm(hand, joints)
            if not self._world.free(touching):
                return False
        return True

    def _path(self, hand: Hand, start: Iterable[float], goal: Floats, stream: tuple[int, int]) -> Floats | None:
        """Return a free path of the arm between two configurations, or None."""

        def valid(joints: Floats) -> bool:
            self._world.set_arm(hand, joints)
            return self._world.free()

        limits = ik.limits(hand)
        wraps = tuple(k in ik.WRAPPING for k in range(len(limits)))
        problem = motion.Problem(limits[:, 0], limits[:, 1], wraps, valid, budget=PATH_BUDGET)
        begin = np.array(list(start))
        present = self._world.robot.arm(hand)
        try:
            return motion.plan(problem, begin, goal, self._seed(*stream))
        finally:
            self._world.set_arm(hand, present)


def free_spots(world: BelievedWorld, table: Standing, carried: Carried) -> Spots:
    """Return the spots on a table with room for a carried object, best first."""
    others = list(on_table(world, table).values())
    return Spots(*grasps.spots(table.type, carried.type, np.reshape(np.array(others, dtype=np.float64), (-1, 3))))


def on_table(world: BelievedWorld, table: Standing) -> dict[str, Disc]:
    """Return the objects on a table, in its frame."""
    table_T_world = inverse2(flat(table.world_T_object))
    return {
        anchor: (*compose2(table_T_world, flat(item.world_T_object))[:2], grasps.widest_half(item.type) + item.spread_m)
        for anchor, item in world.standing.items()
        if item.type.shape != "table" and (world.table_below(item) is table or item.support == table.anchor)
    }


def _at_most(count: int, order: NDArray[np.intp], group: NDArray[np.intp]) -> Iterator[int]:
    """Yield `order` with at most `count` entries of each group, so that no spot uses up all tries."""
    taken: Counter[int] = Counter()
    for k in order:
        taken[int(group[k])] += 1
        if taken[int(group[k])] <= count:
            yield int(k)


def waypoints(path: Floats) -> tuple[Joints7, ...]:
    """Return a path, shape (k, 7), in the form of a message."""
    return tuple((float(a), float(b), float(c), float(d), float(e), float(f), float(g)) for a, b, c, d, e, f, g in path)

"""The geometry that the reasoner consults, answered by planning motions in the believed world.

An answer is a function of (belief, question, run seed): the believed world is built from the belief alone, candidates
are tried in a fixed order, and every path's seed comes from the run's seed, the belief's version and its purpose.
Answers are kept until the belief changes. What cannot be done with things as wide as the doubt about their place is
tried once more with things as they are on average: the alternative would be to give up.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from skolem.sim import arm_motions, grasps, motion, reach, sight, stances
from skolem.sim.arm_motions import ArmPlanner
from skolem.sim.assets import robot_sha256
from skolem.sim.believed import BelievedWorld, Standing
from skolem.sim.driving import MARGINS_M, drive
from skolem.sim.poses import compose2, flat
from skolem.traces.messages import (
    Belief,
    Command,
    Hand,
    LookAt,
    MoveBase,
    ObjectType,
    Pose2,
    Weigh,
)

Floats = NDArray[np.float64]

SENSING_HAND: Hand = "right"  # the only wrist with a force-torque sensor
BASE_STREAM = 3
STANCE_MARGIN_M = MARGINS_M[0]  # distance that all of the robot keeps to everything where it stops
CHECKED_STANCES, SKETCHED_STANCES, JOINED_STANCES = 80, 16, 4  # how many are tried, by rising effort
SAME_M, SAME_RAD = 0.08, 0.2  # stances nearer than this to one that failed are skipped
HEIGHT_STEP_M = 0.02  # reach maps are shared by tool heights that round to the same step
SPOTS, SPOT_APART_M = 12, 0.15  # places on a table for which stances are sought
ROOM_COST = 3.0  # per m of room that a place has less than enough
LOOK_DISTANCES, LOOK_BEARINGS = np.array([0.8, 0.95, 1.1, 1.25, 1.4]), np.array([-0.8, -0.4, 0.0, 0.4, 0.8])
BEST_LOOK_M, LOOK_DISTANCE_COST, LOOK_BEARING_COST = 1.0, 0.5, 0.2

Question = tuple[str, str, str, Hand | None, str | None]


class Activity(Protocol):
    """Something to be done from a base pose: look, pick, place or weigh."""

    @property
    def kind(self) -> str:
        """What is to be done."""
        ...

    @property
    def anchor(self) -> str:
        """The object it is about."""
        ...

    @property
    def hand(self) -> Hand | None:
        """The hand that does it."""
        ...

    @property
    def support(self) -> str | None:
        """Where to place."""
        ...


class PlanningWorld:
    """Answers what can be done from here, and where to go to do it.

    Attributes:
        robot_sha256: Identity of the robot model.
    """

    def __init__(self, types: Mapping[str, ObjectType], seed: int) -> None:
        """Open a physics client of its own.

        Args:
            types: Shape and size of every type a belief may name.
            seed: The run's seed.
        """
        self.robot_sha256 = robot_sha256()
        self._seed = seed
        self._belief: Belief | None = None
        self._world = BelievedWorld(types)
        self._arms = ArmPlanner(self._world, lambda stream, attempt: self._path_seed(stream, attempt))
        self._answers: dict[Question, Command | None] = {}
        self._maps: dict[tuple[Hand, float, int, int], reach.ReachMap] = {}

    def close(self) -> None:
        """Close the physics client; no question can be asked afterwards."""
        self._world.close()

    def sync(self, belief: Belief) -> None:
        """Take over a belief; answers about an equal one are kept."""
        if belief != self._belief:
            self._belief = belief
            self._answers = {}
            self._world.update(belief)

    def ready(self, activity: Activity) -> Command | None:
        """Return the command that does the activity from where the robot is believed to stand, or None."""
        return self._kept("ready", activity, self._ready)

    def approach(self, activity: Activity) -> MoveBase | None:
        """Return a drive to where the activity can be done, and its object or place be seen, or None."""
        answer = self._kept("approach", activity, self._approach)
        assert answer is None or isinstance(answer, MoveBase)
        return answer

    def blockers(self, activity: Activity) -> tuple[str, ...]:
        """Return the movable anchors in the way of the activity."""
        return ()

    def _kept(self, question: str, activity: Activity, answer: Callable[[Activity], Command | None]) -> Command | None:
        key = (question, activity.kind, activity.anchor, activity.hand, activity.support)
        if key not in self._answers:
            self._world.reset()
            command = answer(activity)
            if command is None and activity.kind != "look" and self._world.is_spread():
                with self._world.narrowed():
                    command = answer(activity)
            self._answers[key] = command
        return self._answers[key]

    @property
    def _believed(self) -> Belief:
        assert self._belief is not None, "sync comes first"
        return self._belief

    def _path_seed(self, *stream: int) -> int:
        return motion.seed_of(self._seed, self._believed.version, *stream)

    # ---------------------------------------------------------------- from here

    def _ready(self, activity: Activity) -> Command | None:
        """Return the command from where the robot of the believed world is put."""
        if not self._possible(activity):
            return None
        if activity.kind == "look":
            return self._look(self._world.standing[activity.anchor])
        assert activity.hand is not None
        if activity.kind == "pick":
            return self._arms.pick(activity.hand, activity.anchor)
        if activity.kind == "place":
            assert activity.support is not None
            return self._arms.place(activity.hand, activity.support)
        return Weigh(hand=activity.hand)

    def _look(self, item: Standing) -> LookAt | None:
        turned = sight.look(self._world, item)
        return None if turned is None else LookAt(pan=turned[0], tilt=turned[1])

    def _possible(self, activity: Activity) -> bool:
        """Return whether hands and objects are such that the activity makes sense anywhere."""
        world, hand = self._world, activity.hand
        if activity.kind == "look":
            return activity.anchor in world.standing
        if hand is None:
            return False
        carried = world.carried.get(hand)
        if activity.kind == "pick":
            item = world.standing.get(activity.anchor)
            return carried is None and item is not None and item.type.graspable
        if carried is None or carried.anchor != activity.anchor:
            return False
        if activity.kind == "place":
            table = world.standing.get(activity.support or "")
            return table is not None and table.type.shape == "table"
        return activity.kind == "weigh" and hand == SENSING_HAND

    # ---------------------------------------------------------------- from elsewhere

    def _approach(self, activity: Activity) -> MoveBase | None:
        """Return the drive to the first stance that serves: cheap tests first, whole motions last."""
        if not self._possible(activity):
            return None
        here = self._believed.world_T_base
        if activity.kind == "weigh":
            return MoveBase(start_T_waypoint=((0.0, 0.0, 0.0),))
        drives = 0
        for stance in self._serving(activity):
            path = drive(self._world, here, stance, self._path_seed(BASE_STREAM, drives))
            if path is not None:
                return MoveBase(start_T_waypoint=path)
            drives += 1
        return None

    def _serving(self, activity: Activity) -> Iterator[Pose2]:
        """Yield the base poses from which the activity can be done, in order of preference."""
        candidates, spots = self._candidates(activity)
        failed: list[Pose2] = []
        checked = sketched = joined = 0
        for row, target in zip(candidates.world_T_base, candidates.target, strict=True):
            if checked >= CHECKED_STANCES or sketched >= SKETCHED_STANCES or joined >= JOINED_STANCES:
                return
            stance = (float(row[0]), float(row[1]), float(row[2]))
            if any(_same(stance, other) for other in failed):
                continue
            checked += 1
            self._world.reset(stance)
            if self._world.free() and self._world.clear(STANCE_MARGIN_M) and self._sees(activity, spots, int(target)):
                if activity.kind == "look":
                    yield stance
                    continue
                sketched += 1
                if self._sketch(activity):
                    joined += 1
                    if self._ready(activity) is not None:
                        yield stance
                        continue
            failed.append(stance)

    def _sees(self, activity: Activity, spots: Floats, target: int) -> bool:
        """Return whether the object, or the place for it, is seen from where the robot is put."""
        if activity.support is not None:
            x, y = spots[target]
            return sight.look_at_spot(self._world, self._world.standing[activity.support], (x, y)) is not None
        return sight.look(self._world, self._world.standing[activity.anchor]) is not None

    def _sketch(self, activity: Activity) -> bool:
        """Return whether the arm can do its part near the object, not yet how it gets there."""
        assert activity.hand is not None
        if activity.support is not None:
            return next(self._arms.place_sketches(activity.hand, activity.support), None) is not None
        return next(self._arms.pick_sketches(activity.hand, activity.anchor), None) is not None

    def _candidates(self, activity: Activity) -> tuple[stances.Stances, Floats]:
        """Return base poses whose outline is free, best first, and the places they are for (in a table's frame)."""
        spots = np.zeros((1, 2))
        penalty = np.zeros(1)
        if activity.support is not None:
            assert activity.hand is not None
            table = self._world.standing[activity.support]
            spots, penalty = self._spots(table, activity.hand)
            theta = table.world_T_object[3]
            targets = np.array([compose2(flat(table.world_T_object), (x, y, 0.0))[:2] for x, y in spots])
        else:
            item = self._world.standing[activity.anchor]
            below = self._world.table_below(item)
            theta = (below or item).world_T_object[3]
            targets = np.array([item.world_T_object[:2]])
        directions = stances.headings(theta)
        offsets, quality = self._offsets(activity, directions)
        here = self._believed.world_T_base
        found, cost = stances.around(targets.reshape(-1, 2), penalty, offsets, quality, directions, here)
        return stances.standable(found, cost, [_footprint(item) for item in self._world.ground()]), spots

    def _offsets(self, activity: Activity, directions: Floats) -> tuple[Floats, Floats]:
        """Return where the target may lie in the base frame, (k, 2), and how good that is per heading, (k, h)."""
        if activity.hand is None:
            offsets, good = _look_offsets()
            return offsets, np.tile(good[:, None], len(directions))
        if activity.support is not None:
            carried, table = self._world.carried[activity.hand], self._world.standing[activity.support]
            height = table.world_T_object[2] + table.type.size_m[2] + grasps.RELEASE_M - carried.tool_T_object[2]
            found = self._reach_map(activity.hand, height, grasps.back_off(carried.type, 0.0))
            return found.offsets, np.tile(found.quality()[:, None], len(directions))
        item = self._world.standing[activity.anchor]
        height = item.world_T_object[2] + grasps.tool_height(item.type)
        found = self._reach_map(activity.hand, height, grasps.back_off(item.type, item.spread_m))
        if item.type.shape == "cylinder":
            return found.offsets, np.tile(found.quality()[:, None], len(directions))
        yaws = [grasps.approach_yaws(item.type, item.world_T_object[3] - float(heading)) for heading in directions]
        return found.offsets, np.stack([found.quality(yaw) for yaw in yaws], axis=1)

    def _reach_map(self, hand: Hand, height: float, back: float) -> reach.ReachMap:
        key = (hand, self._believed.robot.torso, round(height / HEIGHT_STEP_M), math.ceil(back / HEIGHT_STEP_M))
        if key not in self._maps:
            rounded = key[2] * HEIGHT_STEP_M, key[3] * HEIGHT_STEP_M
            self._maps[key] = reach.reach_map(hand, key[1], *rounded, arm_motions.LIFT_M)
        return self._maps[key]

    def _spots(self, table: Standing, hand: Hand) -> tuple[Floats, Floats]:
        """Return a few places on a table, apart from one another, and the cost of the room they lack."""
        places, room = arm_motions.free_spots(self._world, table, self._world.carried[hand])
        chosen: list[int] = []
        for k in range(len(places)):
            if len(chosen) < SPOTS and all(math.dist(places[k], places[j]) >= SPOT_APART_M for j in chosen):
                chosen.append(k)
        return places[chosen], ROOM_COST * (grasps.ENOUGH_M - room[chosen])


def _same(a: Pose2, b: Pose2) -> bool:
    """Return whether two base poses are so near that what fails at one will fail at the other."""
    turn = abs((a[2] - b[2] + math.pi) % (2.0 * math.pi) - math.pi)
    return math.dist(a[:2], b[:2]) < SAME_M and turn < SAME_RAD


def _footprint(item: Standing) -> stances.Footprint:
    """Return the rectangle on the floor that an object takes."""
    half = item.type.size_m[0] / 2.0 + item.spread_m, item.type.size_m[1] / 2.0 + item.spread_m
    return stances.Footprint(flat(item.world_T_object), half)


def _look_offsets() -> tuple[Floats, Floats]:
    """Return where a thing to look at may lie in the base frame, and how good each offset is."""
    distance, bearing = (a.ravel() for a in np.meshgrid(LOOK_DISTANCES, LOOK_BEARINGS, indexing="ij"))
    offsets = np.stack([distance * np.cos(bearing), distance * np.sin(bearing)], axis=1)
    worse = LOOK_DISTANCE_COST * np.abs(distance - BEST_LOOK_M) + LOOK_BEARING_COST * np.abs(bearing)
    return offsets, 1.0 - worse

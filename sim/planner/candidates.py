"""Candidate base poses for an activity, best first."""

import math

import numpy as np
from numpy.typing import NDArray

from skolem.sim.planner import arm_motions, stances
from skolem.sim.planner.arm_motions import Spots
from skolem.sim.planner.believed import BelievedWorld
from skolem.sim.planner.standing import Standing
from skolem.sim.robot import reach
from skolem.sim.space import grasps
from skolem.traces.messages import Activity, Hand, ObjectType, Pose2
from skolem.traces.messages.poses import compose2, flat

Floats = NDArray[np.float64]

HEIGHT_STEP_M = 0.02  # reach maps are shared by tool heights that round to the same step
SPOTS, SPOT_APART_M = 24, 0.20  # number and least distance of spots on a table for which stances are sought
ROOM_COST = 3.0  # per m of room that a spot lacks
LOOK_DISTANCES, LOOK_BEARINGS = np.array([0.8, 0.95, 1.1, 1.25, 1.4]), np.array([-0.8, -0.4, 0.0, 0.4, 0.8])
BEST_LOOK_M, LOOK_DISTANCE_COST, LOOK_BEARING_COST = 1.0, 0.5, 0.2
SURVEY_HEADINGS = 12


class Candidates:
    """Finds base poses in the believed world; only the base's outline is checked for collisions."""

    def __init__(self, world: BelievedWorld) -> None:
        """Keep the world; reach maps are made on first use and kept."""
        self._world = world
        self._maps: dict[tuple[Hand, float, int, int], reach.ReachMap] = {}

    def around_object(self, activity: Activity, here: Pose2) -> stances.Stances:
        """Return base poses for looking at an object or picking it."""
        item = self._world.standing[activity.anchor]
        below = self._world.table_below(item)
        directions = stances.headings((below or item).world_T_object[3])
        offsets, quality = self._offsets(item, activity.hand, directions)
        targets = np.array([item.world_T_object[:2]])
        found, cost = stances.around(targets, np.zeros(1), offsets, quality, directions, here)
        return stances.standable(found, cost, self._outlines())

    def around_spots(
        self, table: Standing, hand: Hand, carried: ObjectType, below_tool_m: float, spots: Spots, here: Pose2
    ) -> tuple[stances.Stances, Floats]:
        """Return base poses for placing an object on a table, and the spots they are for, in the table's frame.

        Args:
            table: The table.
            hand: The hand that holds the object, now or then.
            carried: The type of the object.
            below_tool_m: How far the object's base face is below the tool.
            spots: The spots.
            here: Present pose of the base.
        """
        places, penalty = _spread_out(spots)
        directions = stances.headings(table.world_T_object[3])
        targets = np.array([compose2(flat(table.world_T_object), (x, y, 0.0))[:2] for x, y in places])
        height = table.world_T_object[2] + table.type.size_m[2] + grasps.RELEASE_M + below_tool_m
        found = self._reach_map(hand, height, grasps.back_off(carried, 0.0))
        quality = np.tile(found.quality()[:, None], len(directions))
        around, cost = stances.around(targets.reshape(-1, 2), penalty, found.offsets, quality, directions, here)
        return stances.standable(around, cost, self._outlines()), places

    def around_region(self, support: Standing, middle: tuple[float, float], here: Pose2) -> stances.Stances:
        """Return base poses that face the middle of a region's unseen part, from all sides of its support."""
        offsets = np.stack([LOOK_DISTANCES, np.zeros_like(LOOK_DISTANCES)], axis=1)
        directions = stances.headings(support.world_T_object[3])[:: stances.HEADINGS // SURVEY_HEADINGS]
        quality = np.ones((len(offsets), len(directions)))
        found, cost = stances.around(np.array([middle]), np.zeros(1), offsets, quality, directions, here)
        return stances.standable(found, cost, self._outlines(), stances.AMPLE_M)

    def _outlines(self) -> list[stances.Footprint]:
        return [_footprint(item) for item in self._world.ground()]

    def _offsets(self, item: Standing, hand: Hand | None, directions: Floats) -> tuple[Floats, Floats]:
        """Return positions of an object in the base frame, (k, 2), and the quality of each per heading, (k, h)."""
        if hand is None:
            offsets, good = _look_offsets()
            return offsets, np.tile(good[:, None], len(directions))
        height = item.world_T_object[2] + grasps.tool_height(item.type)
        found = self._reach_map(hand, height, grasps.back_off(item.type, item.spread_m))
        if item.type.shape == "cylinder":
            return found.offsets, np.tile(found.quality()[:, None], len(directions))
        yaws = [grasps.approach_yaws(item.type, item.world_T_object[3] - float(heading)) for heading in directions]
        return found.offsets, np.stack([found.quality(yaw) for yaw in yaws], axis=1)

    def _reach_map(self, hand: Hand, height: float, back: float) -> reach.ReachMap:
        torso = self._world.robot.state().torso
        key = (hand, torso, round(height / HEIGHT_STEP_M), math.ceil(back / HEIGHT_STEP_M))
        if key not in self._maps:
            rounded = key[2] * HEIGHT_STEP_M, key[3] * HEIGHT_STEP_M
            self._maps[key] = reach.reach_map(hand, torso, *rounded, arm_motions.LIFT_M)
        return self._maps[key]


def _spread_out(spots: Spots) -> tuple[Floats, Floats]:
    """Return spots that are spread over all free parts of a table, and the cost of the room that each lacks."""
    chosen: list[int] = []
    for k in range(len(spots.places)):
        if len(chosen) < SPOTS and all(math.dist(spots.places[k], spots.places[j]) >= SPOT_APART_M for j in chosen):
            chosen.append(k)
    return spots.places[chosen], ROOM_COST * (grasps.ENOUGH_M - spots.room[chosen])


def _footprint(item: Standing) -> stances.Footprint:
    """Return the rectangle of an object on the floor."""
    half = item.type.size_m[0] / 2.0 + item.spread_m, item.type.size_m[1] / 2.0 + item.spread_m
    return stances.Footprint(flat(item.world_T_object), half)


def _look_offsets() -> tuple[Floats, Floats]:
    """Return positions, in the base frame, of an object to look at, and the quality of each."""
    distance, bearing = (a.ravel() for a in np.meshgrid(LOOK_DISTANCES, LOOK_BEARINGS, indexing="ij"))
    offsets = np.stack([distance * np.cos(bearing), distance * np.sin(bearing)], axis=1)
    worse = LOOK_DISTANCE_COST * np.abs(distance - BEST_LOOK_M) + LOOK_BEARING_COST * np.abs(bearing)
    return offsets, 1.0 - worse

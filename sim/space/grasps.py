"""Grasps of upright objects, and spots on tables where objects can be put down.

Grasps are from the side with level fingers. All poses here are in the frame of `base_footprint` unless named otherwise.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.traces.messages import ObjectType, Pose4
from skolem.traces.messages.poses import compose4, inverse4, wrap_half_open

Floats = NDArray[np.float64]

WIDEST_M = 0.08  # widest object between open fingers, with 3 mm on each side
GRASP_HEIGHT = 0.6  # of the object's height
PALM_CLEARANCE_M = 0.045  # half the gripper's height: the least height of the tool above the table
TOP_CLEARANCE_M = 0.01  # the fingers close below the top edge by this much
PAST_AXIS_M = 0.005  # how far the tool frame goes beyond the object's axis
FINGERTIP_M = 0.03  # distance of the fingertips before the tool frame, with a little air
BACK_OFF_M = 0.10  # least distance of the pregrasp
STEEPEST_RAD = 1.4  # grasps that point further sideways are not tried
YAWS = 9
EDGE_M = 0.08  # least distance from an object's centre to the table's edge
NEIGHBOUR_M = 0.06  # least gap to objects on the table
ENOUGH_M = 0.20  # more distance than this to edges and neighbours is no better
GRID_M = 0.06
RELEASE_M = 0.005  # height above the table where the fingers open


@dataclass(frozen=True, slots=True)
class Grasp:
    """A grasp: the pose of the tool at the object, in the frame of the object's given pose."""

    base_T_tool: Pose4
    tool_T_object: Pose4


def widest_half(object_type: ObjectType) -> float:
    """Return the largest horizontal distance of an object's surface from its axis, metres."""
    x, y, _ = object_type.size_m
    return math.hypot(x, y) / 2.0 if object_type.shape == "box" else x / 2.0


def back_off(object_type: ObjectType, spread_m: float) -> float:
    """Return the distance before the grasp at which open fingers are clear of the object and its doubt, metres."""
    return max(BACK_OFF_M, widest_half(object_type) + spread_m + FINGERTIP_M + PAST_AXIS_M)


def tool_height(object_type: ObjectType) -> float:
    """Return the height of the tool above the base face at the grasp, metres."""
    height = object_type.size_m[2]
    return min(max(GRASP_HEIGHT * height, PALM_CLEARANCE_M), height - TOP_CLEARANCE_M)


def approach_yaws(object_type: ObjectType, theta: float) -> Floats:
    """Return yaws of the fingers, ascending: a grid for a cylinder, across narrow faces for a box at `theta`."""
    if not object_type.graspable:
        return np.empty(0)
    if object_type.shape == "cylinder":
        fits = object_type.size_m[0] < WIDEST_M
        return np.linspace(-STEEPEST_RAD, STEEPEST_RAD, YAWS) if fits else np.empty(0)
    quarter = [k for k in range(4) if object_type.size_m[1 - k % 2] < WIDEST_M]
    turned = [wrap_half_open(theta + k * math.pi / 2.0) for k in quarter]
    return np.array(sorted(yaw for yaw in turned if abs(yaw) <= STEEPEST_RAD))


def grasp(object_type: ObjectType, base_T_object: Pose4, yaw: float) -> Grasp:
    """Return the grasp of an object from direction `yaw`."""
    x, y, z, _ = base_T_object
    ahead = (PAST_AXIS_M * math.cos(yaw), PAST_AXIS_M * math.sin(yaw))
    base_T_tool = (x + ahead[0], y + ahead[1], z + tool_height(object_type), yaw)
    return Grasp(base_T_tool, compose4(inverse4(base_T_tool), base_T_object))


def spots(table: ObjectType, thing: ObjectType, others: Floats) -> tuple[Floats, Floats]:
    """Return spots for the centre of an object on a table, best first, and the room around each.

    Args:
        table: The type of the table; positions are in its frame.
        thing: The type of the object to put down.
        others: Shape (n, 3): x, y and largest half width of the objects on the table.

    Returns:
        Spots, shape (k, 2), by falling room; room, shape (k,): the distance to the nearest edge or the gap to the
        nearest neighbour, at most `ENOUGH_M`. For equal room, spots nearer to the middle line across the table's depth
        come first.
    """
    half, radius = np.array(table.size_m[:2]) / 2.0, widest_half(thing)
    margin = max(EDGE_M, radius)
    if half.min() < margin:
        return np.empty((0, 2)), np.empty(0)
    axes = [np.linspace(-1.0, 1.0, 2 * math.floor((h - margin) / GRID_M) + 1) * (h - margin) for h in half]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    room = (half - np.abs(places)).min(axis=1)
    for x, y, other in others:
        gap = np.hypot(places[:, 0] - x, places[:, 1] - y) - radius - other
        room = np.where(gap < NEIGHBOUR_M, -1.0, np.minimum(room, gap))
    places, room = places[room > 0.0], np.minimum(room[room > 0.0], ENOUGH_M)
    order = np.lexsort((places[:, 0], places[:, 1], np.round(np.abs(places[:, 1]), 6), -np.round(room, 6)))
    return places[order], room[order]

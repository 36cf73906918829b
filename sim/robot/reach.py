"""The reach of an arm at level tool poses: ranked configurations for grasps, and maps for choosing base poses."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.sim.robot import ik
from skolem.traces.messages import Hand, Pose4
from skolem.traces.messages.arm import SHOULDER_M, UPPER_ARM_M

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

PANS = 24
COMFORT_RAD = 0.25  # a greater distance from the joint limits is no better
NEAR_LIMIT_COST = 4.0  # per rad nearer to a limit than COMFORT_RAD
TURN_COST = 0.15  # per rad of the largest turn from the present configuration
LOW_ELBOW_COST = 3.0  # per m that the elbow hangs below the tool, where the forearm meets the table's edge
BENT_LIMITS = (0, 1, 2, 3, 5)  # joints that have limits
LEAST_MARGIN_RAD = 0.05  # least margin of an offered configuration
MAP_X, MAP_Y, MAP_STEP_M = (0.40, 0.95), (-0.70, 0.25), 0.05  # of the right hand; the left mirrors y
MAP_YAW_STEP_RAD = 0.35
MAP_YAWS, MAP_PANS = np.arange(-3, 4) * MAP_YAW_STEP_RAD, 12
YAW_COST = 0.3  # per rad by which the only direction of a grasp points sideways
MAP_MARGIN_RAD, MAP_ELBOW_M = 0.12, 0.0  # least margin to joint limits and least height of the elbow over the tool


@dataclass(frozen=True, slots=True)
class Reaching:
    """Configurations that put the tool at one of several poses, best first.

    Attributes:
        pose: Index of the pose, shape (k,).
        joints: Shape (k, 7) [rad].
        cost: Shape (k,), ascending.
    """

    pose: Ints
    joints: Floats
    cost: Floats


def rotations(yaw: Floats) -> Floats:
    """Return rotations about z, shape (n, 3, 3)."""
    out = np.zeros((len(yaw), 3, 3))
    out[:, 0, 0] = out[:, 1, 1] = np.cos(yaw)
    out[:, 1, 0] = np.sin(yaw)
    out[:, 0, 1] = -out[:, 1, 0]
    out[:, 2, 2] = 1.0
    return out


def limit_margin(hand: Hand, joints: Floats) -> Floats:
    """Return the least distance [rad] of any joint to its limit, shape (k,), for configurations (k, 7)."""
    limits = ik.limits(hand)
    room = np.minimum(joints - limits[:, 0], limits[:, 1] - joints)
    return np.asarray(room[:, BENT_LIMITS].min(axis=1))


def elbow_height(torso: float, joints: Floats) -> Floats:
    """Return the height of the elbow over the floor, metres, shape (k,), for configurations (k, 7)."""
    return np.asarray(SHOULDER_M[2] + torso - UPPER_ARM_M * np.sin(joints[:, 1]))


def reaching(hand: Hand, torso: float, base_T_tool: list[Pose4], present: Floats) -> Reaching:
    """Return configurations for level tool poses, by cost: far from limits, elbow up, near the present one.

    Args:
        hand: Which arm.
        torso: Torso lift [m].
        base_T_tool: The poses, in any number.
        present: Shape (7,), the arm's configuration now.
    """
    poses = np.reshape(np.array(base_T_tool, dtype=np.float64), (-1, 4))
    which = np.repeat(np.arange(len(poses)), PANS)
    pan = np.tile(ik.pan_grid(hand, PANS), len(poses))
    found = ik.solve(hand, torso, poses[which, :3], rotations(poses[which, 3]), pan)
    joints = ik.nearest_turn(found.joints, np.broadcast_to(present, found.joints.shape))
    margin = limit_margin(hand, joints)
    turn = np.abs(joints - present).max(axis=1, initial=0.0)
    hangs = np.maximum(0.0, poses[which[found.row], 2] - elbow_height(torso, joints))
    cost = NEAR_LIMIT_COST * np.maximum(0.0, COMFORT_RAD - margin) + TURN_COST * turn + LOW_ELBOW_COST * hangs
    keep = np.flatnonzero(margin >= LEAST_MARGIN_RAD)
    keep = keep[np.argsort(np.round(cost[keep], 9), kind="stable")]
    return Reaching(which[found.row[keep]], joints[keep], cost[keep])


@dataclass(frozen=True, slots=True)
class ReachMap:
    """The positions relative to the base where an arm can grasp, back off and lift at one height.

    Attributes:
        offsets: Shape (k, 2), object positions in the base frame.
        works: Shape (k, yaws), for each direction of `MAP_YAWS`: 1 if it works there and within two steps all around,
            0.5 if it works within one step, 0 otherwise.
    """

    offsets: Floats
    works: Floats

    def quality(self, yaws: Floats | None = None) -> Floats:
        """Return the quality of each offset, shape (k,), 0..1: the mean over directions, or the best of given ones."""
        if yaws is None:
            return np.asarray(self.works.mean(axis=1))
        nearest = np.abs(MAP_YAWS[:, None] - yaws).argmin(axis=0)
        near = np.abs(MAP_YAWS[nearest] - yaws) <= MAP_YAW_STEP_RAD / 2.0 + 1e-9
        straight = np.maximum(0.0, 1.0 - YAW_COST * np.abs(yaws[near]))
        return np.asarray((self.works[:, nearest[near]] * straight).max(axis=1, initial=0.0))


def reach_map(hand: Hand, torso: float, height: float, back_off: float, lift: float) -> ReachMap:
    """Return the reach map for tool poses at a height over the floor.

    A direction works at a position if the arm has a configuration for the grasp, for the pregrasp `back_off` before it
    and for the end of the lift. Neighbouring positions count too, since the base stops a little beside the planned
    pose.
    """
    xs, ys = (np.arange(low, high + 1e-9, MAP_STEP_M) for low, high in (MAP_X, MAP_Y))
    ys = ys if hand == "right" else -ys[::-1]
    x, y, yaw = (a.ravel() for a in np.meshgrid(xs, ys, MAP_YAWS, indexing="ij"))
    ahead = np.stack([np.cos(yaw), np.sin(yaw), np.zeros_like(yaw)], axis=1)
    at = np.stack([x, y, np.full_like(x, height)], axis=1)
    ok = np.ones(len(x), dtype=bool)
    for positions in (at, at - back_off * ahead, at + np.array([0.0, 0.0, lift])):
        ok[ok] = _reached(hand, torso, positions[ok], yaw[ok])
    once = _all_around(ok.reshape(len(xs), len(ys), len(MAP_YAWS)))
    works = (once.astype(np.float64) + _all_around(once)) / 2.0
    grid = np.stack(np.meshgrid(xs, ys, indexing="ij"), axis=-1)
    return ReachMap(grid.reshape(-1, 2), works.reshape(-1, len(MAP_YAWS)))


def _reached(hand: Hand, torso: float, positions: Floats, yaw: Floats) -> NDArray[np.bool_]:
    """Return the mask of level tool poses with a configuration well within the limits and with the elbow up."""
    n = len(positions)
    pan = np.tile(ik.pan_grid(hand, MAP_PANS), n)
    which = np.repeat(np.arange(n), MAP_PANS)
    found = ik.solve(hand, torso, positions[which], rotations(yaw)[which], pan)
    at_ease = limit_margin(hand, found.joints) >= MAP_MARGIN_RAD
    elbow_up = elbow_height(torso, found.joints) >= positions[which[found.row], 2] + MAP_ELBOW_M
    out = np.zeros(n, dtype=bool)
    out[which[found.row[at_ease & elbow_up]]] = True
    return out


def _all_around(works: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the mask, shape (x, y, yaw), of cells that work with all eight neighbours; beyond the border none does."""
    padded = np.pad(works, ((1, 1), (1, 1), (0, 0)))
    rows, columns, _ = works.shape
    shifted = [padded[i : i + rows, j : j + columns] for i in range(3) for j in range(3)]
    return np.asarray(np.all(shifted, axis=0))

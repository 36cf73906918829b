"""Inverse kinematics of a PR2 arm in closed form: all solutions for given values of the shoulder pan.

The arm is a shoulder (z, then 0.1 m forward, then y, x), an elbow (y) and a wrist (x, y, x) whose centre is fixed by
the tool pose. With the pan given, the wrist centre fixes elbow, lift and upper-arm roll (two solutions), and the
wrist's X-Y-X Euler angles follow. The solutions and their order are a function of the arguments, without seed or
iteration.

Tool poses are given in the frame of `base_footprint` (z = 0 on the floor); x of the tool points along the fingers.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.traces.messages import Hand
from skolem.traces.messages.arm import FOREARM_M, PAN_TO_LIFT_M, UPPER_ARM_M, WRIST_TO_TOOL_M, shoulder

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

WRAPPING = (4, 6)  # forearm roll and wrist roll turn without end
STEP_LIMIT_RAD = 0.35  # largest turn of a joint between two poses of a straight line; a larger one changes the branch
PAN_WINDOW_RAD, PAN_WINDOW_POINTS = 0.16, 17  # search range for the shoulder pan of the next pose
_LIMITS_LEFT = (
    (-0.714601836603, 2.2853981634),
    (-0.5236, 1.3963),
    (-0.8, 3.9),
    (-2.3213, 0.0),
    (-math.pi, math.pi),
    (-2.094, 0.0),
    (-math.pi, math.pi),
)


def limits(hand: Hand) -> Floats:
    """Return the joint limits, shape (7, 2) [rad]; the right arm mirrors pan and upper-arm roll of the left."""
    table = np.array(_LIMITS_LEFT)
    if hand == "right":
        table[[0, 2]] = -table[[0, 2], ::-1]
    return table


@dataclass(frozen=True, slots=True)
class Solutions:
    """Arm configurations, each with the index of its question.

    Attributes:
        row: Index of the question, shape (k,), ascending.
        joints: Joint values, shape (k, 7) [rad], continuous joints in [-pi, pi].
    """

    row: Ints
    joints: Floats


def solve(hand: Hand, torso: float, position: Floats, rotation: Floats, pan: Floats) -> Solutions:
    """Return every configuration within the limits, for n questions at once.

    Args:
        hand: Which arm.
        torso: Value of the torso lift [m].
        position: Shape (n, 3), tool positions, base_footprint.
        rotation: Shape (n, 3, 3), tool orientations, base_footprint.
        pan: Shape (n,), the shoulder pan to use [rad], within its limits.
    """
    lim = limits(hand)
    wrist = position - WRIST_TO_TOOL_M * rotation[:, :, 0] - np.array(shoulder(hand, torso))
    x = np.cos(pan) * wrist[:, 0] + np.sin(pan) * wrist[:, 1] - PAN_TO_LIFT_M
    y = -np.sin(pan) * wrist[:, 0] + np.cos(pan) * wrist[:, 1]
    row, upper = _upper_arm(np.stack([x, y, wrist[:, 2]], axis=1), lim)
    upper = np.column_stack([pan[row], upper])
    lower = _wrist(upper, rotation[row])
    keep = lower[:, 1] >= lim[5, 0]
    row, joints = row[keep], np.hstack([upper, lower])[keep]
    order = np.argsort(row, kind="stable")
    return Solutions(row[order], joints[order])


def _upper_arm(wrist: Floats, lim: Floats) -> tuple[Ints, Floats]:
    """Return the question of each solution, shape (k,), and its shoulder lift, upper-arm roll and elbow flex, (k, 3).

    Args:
        wrist: Shape (n, 3), wrist centres seen from the lift axis, turned by the pan.
        lim: Shape (7, 2), joint limits.
    """
    squares = UPPER_ARM_M**2 + FOREARM_M**2
    cos4 = ((wrist**2).sum(axis=1) - squares) / (2.0 * UPPER_ARM_M * FOREARM_M)
    q4 = -np.arccos(np.clip(cos4, -1.0, 1.0))
    along, across = UPPER_ARM_M + FOREARM_M * cos4, -FOREARM_M * np.sin(q4)
    sin3 = -wrist[:, 1] / np.maximum(across, 1e-9)
    row = np.flatnonzero((np.abs(cos4) <= 1.0) & (np.abs(sin3) <= 1.0) & (q4 >= lim[3, 0]))
    first = np.arcsin(sin3[row])
    q3 = np.concatenate([first, math.pi - first])
    row = np.concatenate([row, row])
    along, fore, q4 = along[row], np.cos(q3) * across[row], q4[row]
    x, z = wrist[row, 0], wrist[row, 2]
    q2 = np.arctan2(fore * x - along * z, along * x + fore * z)
    q3 = (q3 - lim[2, 0]) % (2.0 * math.pi) + lim[2, 0]
    keep = (q2 >= lim[1, 0]) & (q2 <= lim[1, 1]) & (q3 <= lim[2, 1])
    return row[keep], np.column_stack([q2, q3, q4])[keep]


def _wrist(upper: Floats, rotation: Floats) -> Floats:
    """Return forearm roll, wrist flex (never positive) and wrist roll, shape (k, 3), by X-Y-X Euler angles.

    Args:
        upper: Shape (k, 4), the first four joints.
        rotation: Shape (k, 3, 3), tool orientations.
    """
    turned = _about(2, upper[:, 0]) @ _about(1, upper[:, 1]) @ _about(0, upper[:, 2]) @ _about(1, upper[:, 3])
    m = np.swapaxes(turned, 1, 2) @ rotation
    q6 = -np.arccos(np.clip(m[:, 0, 0], -1.0, 1.0))
    sin6 = np.sin(q6)
    regular = np.abs(sin6) > 1e-9
    scale = np.where(regular, sin6, 1.0)
    q7 = np.where(regular, np.arctan2(m[:, 0, 1] / scale, m[:, 0, 2] / scale), 0.0)
    q5 = np.where(regular, np.arctan2(m[:, 1, 0] / scale, -m[:, 2, 0] / scale), np.arctan2(m[:, 2, 1], m[:, 1, 1]))
    return np.column_stack([q5, q6, q7])


def _about(axis: int, angle: Floats) -> Floats:
    """Return rotations about a coordinate axis, shape (n, 3, 3)."""
    c, s, out = np.cos(angle), np.sin(angle), np.zeros((len(angle), 3, 3))
    i, j = ((1, 2), (2, 0), (0, 1))[axis]
    out[:, axis, axis] = 1.0
    out[:, i, i], out[:, j, j] = c, c
    out[:, i, j], out[:, j, i] = -s, s
    return out


def pan_grid(hand: Hand, count: int) -> Floats:
    """Return `count` values over the range of the shoulder pan."""
    lower, upper = limits(hand)[0]
    return np.linspace(lower, upper, count)


def all_solutions(hand: Hand, torso: float, position: Floats, rotation: Floats, pan: Floats) -> Floats:
    """Return every configuration, shape (k, 7), for one tool pose, shapes (3,) and (3, 3), and given pans, (n,)."""
    n = len(pan)
    return solve(hand, torso, np.tile(position, (n, 1)), np.tile(rotation, (n, 1, 1)), pan).joints


def nearest_turn(joints: Floats, reference: Floats) -> Floats:
    """Return the configurations with continuous joints turned to within pi of `reference`."""
    turned = np.array(joints)
    for k in WRAPPING:
        difference = turned[..., k] - reference[..., k]
        turned[..., k] = reference[..., k] + (difference + math.pi) % (2.0 * math.pi) - math.pi
    return turned


def follow(hand: Hand, torso: float, start: Floats, positions: Floats, rotation: Floats) -> Floats | None:
    """Return configurations along tool positions, each near the one before; None if the branch ends.

    Args:
        hand: Which arm.
        torso: Value of the torso lift [m].
        start: Shape (7,), the configuration before the first position.
        positions: Shape (n, 3), tool positions a few centimetres apart, base_footprint.
        rotation: Shape (3, 3), the tool's orientation throughout.

    Returns:
        Shape (n, 7); continuous joints run on without jumps.
    """
    lower, upper = limits(hand)[0]
    out: list[Floats] = []
    last = start
    for position in positions:
        window = np.linspace(-PAN_WINDOW_RAD, PAN_WINDOW_RAD, PAN_WINDOW_POINTS)
        pan = np.clip(last[0] + window, lower, upper)
        found = nearest_turn(all_solutions(hand, torso, position, rotation, pan), last)
        if not len(found):
            return None
        turn = np.abs(found - last).max(axis=1)
        best = int(np.argmin(turn))
        if turn[best] > STEP_LIMIT_RAD:
            return None
        last = found[best]
        out.append(last)
    return np.array(out)

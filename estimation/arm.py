"""Forward kinematics of the PR2's arms. The encoders are exact, and so are the poses of the hands in the base frame."""

import math

import numpy as np
from numpy.typing import NDArray

from skolem.traces.messages import Hand, Pose2, RobotState
from skolem.traces.messages.arm import CHAIN, shoulder


def base_T_tool(robot: RobotState, hand: Hand) -> NDArray[np.float64]:
    """Return the pose of a hand's tool frame (x along the fingers) in the base frame, shape (4, 4)."""
    return _frames(robot, hand)[-1]


def joints_base(robot: RobotState, hand: Hand) -> NDArray[np.float64]:
    """Return the positions of an arm's shoulder, joints and tool frame, in this order, shape (8, 3), base frame."""
    return np.array([frame[:3, 3] for frame in _frames(robot, hand)])


def _frames(robot: RobotState, hand: Hand) -> list[NDArray[np.float64]]:
    """Return the poses of the shoulder and of the ends of all links, each of shape (4, 4), base frame."""
    pose = np.eye(4)
    pose[:3, 3] = shoulder(hand, robot.torso)
    angles = robot.right_arm if hand == "right" else robot.left_arm
    frames = [pose]
    for (axis, length), angle in zip(CHAIN, angles, strict=True):
        pose = pose @ _turn(axis, angle)
        pose[:3, 3] += length * pose[:3, 0]
        frames.append(pose)
    return frames


def upright(x: float, y: float, z: float, theta: float) -> NDArray[np.float64]:
    """Return the pose of an upright frame at a point (metres) and heading (radians), shape (4, 4)."""
    pose = _turn("z", theta)
    pose[:3, 3] = (x, y, z)
    return pose


def flattened(pose: NDArray[np.float64]) -> Pose2:
    """Return (x, y, heading of the x axis) of a pose of shape (4, 4)."""
    return (float(pose[0, 3]), float(pose[1, 3]), math.atan2(pose[1, 0], pose[0, 0]))


def _turn(axis: str, angle: float) -> NDArray[np.float64]:
    """Return the rotation about a coordinate axis, shape (4, 4)."""
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    turn = np.eye(4)
    turn[i, i] = turn[j, j] = math.cos(angle)
    turn[j, i] = math.sin(angle)
    turn[i, j] = -math.sin(angle)
    return turn

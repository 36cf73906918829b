"""The PR2's arms as numbers: the chain from the shoulder to the tool, and the pose in which objects are carried.

Link offsets are those of the published PR2 model: shoulder at (-0.05, +-0.188, 0.739675) above `base_link`, which is
0.051 m above the floor; upper arm 0.4 m, forearm 0.321 m, tool frame 0.18 m beyond the wrist.
"""

from collections.abc import Mapping
from types import MappingProxyType

from skolem.traces.messages.base import Hand, Joints7

SHOULDER_M = (-0.05, 0.188, 0.790675)  # pan axis of the left shoulder, base frame on the floor, torso at 0
PAN_TO_LIFT_M, UPPER_ARM_M, FOREARM_M, WRIST_TO_TOOL_M = 0.1, 0.4, 0.321, 0.18
# (joint axis, distance to the next joint along x, metres), from the shoulder's pan to the tool
CHAIN = (
    ("z", PAN_TO_LIFT_M),
    ("y", 0.0),
    ("x", UPPER_ARM_M),
    ("y", 0.0),
    ("x", FOREARM_M),
    ("y", 0.0),
    ("x", WRIST_TO_TOOL_M),
)
CARRY: Mapping[Hand, Joints7] = MappingProxyType(  # tool level at (0.45, -+0.50, 1.00) when the torso is at 0.2
    {
        "right": (-0.72, 0.84865, 0.08833, -2.15891, -2.34645, -1.42687, 2.91387),
        "left": (0.72, 0.84865, -0.08833, -2.15891, 2.34645, -1.42687, -2.91387),
    }
)


def shoulder(hand: Hand, torso: float) -> tuple[float, float, float]:
    """Return the point where the axis of the shoulder's pan meets the chain, base frame, metres.

    Args:
        hand: Which arm; the right one mirrors the left.
        torso: Value of the torso lift, metres.
    """
    x, y, z = SHOULDER_M
    return (x, y if hand == "left" else -y, z + torso)

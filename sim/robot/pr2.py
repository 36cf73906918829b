"""The PR2 in a physics client: names, limits, joint values, frames, and the head angles that show a point.

The base moves by three joints of its own, so `world_T_base` is the pose of `base_footprint` on the floor. The module
neither steps the physics nor plans; several clients may each have a robot.
"""

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from skolem.sim.robot.assets import patched_urdf_path, quiet_output, srdf_path
from skolem.sim.robot.bullet import p
from skolem.traces.messages import HANDS, Hand, Joints7, Pose2, Pose4, RobotState
from skolem.traces.messages.arm import CARRY
from skolem.traces.messages.poses import Quaternion, Vector3, heading, wrap_half_open

BASE = ("base_x", "base_y", "base_theta")
TORSO = "torso_lift_joint"
HEAD = ("head_pan_joint", "head_tilt_joint")
CAMERA_FRAME = "head_mount_kinect_ir_link"  # x forward, y left, z up
_ARM = ("shoulder_pan", "shoulder_lift", "upper_arm_roll", "elbow_flex", "forearm_roll", "wrist_flex", "wrist_roll")
_FINGERS = ("l_finger", "r_finger", "l_finger_tip", "r_finger_tip")
_ROOTS = ("l_parallel_root", "r_parallel_root")
ARM: Mapping[Hand, tuple[str, ...]] = MappingProxyType(
    {hand: tuple(f"{hand[0]}_{name}_joint" for name in _ARM) for hand in HANDS}
)
FINGERS: Mapping[Hand, tuple[str, ...]] = MappingProxyType(
    {hand: tuple(f"{hand[0]}_gripper_{name}_joint" for name in _FINGERS) for hand in HANDS}
)
TOOL_FRAME: Mapping[Hand, str] = MappingProxyType({hand: f"{hand[0]}_gripper_tool_frame" for hand in HANDS})
FINGER_OPEN_RAD = 0.5  # of 0.548: fingertips 8.6 cm apart


class PR2:
    """One robot in one client, with its index maps.

    Attributes:
        client: The physics client.
        id: The robot's body in it.
        joint: Index of each joint by name.
        link: Index of each link by name; the root has -1.
        limits: (lower, upper) of each joint in rad or m; a continuous joint has (-pi, pi).
        movable: Indices of the joints that are not fixed, ascending.
    """

    def __init__(self, client: int, self_collision: bool = False) -> None:
        """Load the patched model at the world's origin, both arms in carry pose.

        Args:
            client: Physics client.
            self_collision: Whether contacts between its own links count, except pairs that the SRDF disables. For
                planning only: with it, a physics step costs 3.6 times as much.
        """
        self.client = client
        flags = p.URDF_USE_SELF_COLLISION if self_collision else 0
        with quiet_output():
            self.id: int = p.loadURDF(str(patched_urdf_path()), useFixedBase=True, flags=flags, physicsClientId=client)
        self._index_joints()
        if self_collision:
            self._filter_self_collision()
        self._head = self._head_offsets()
        self.set_joints(dict(zip((*ARM["right"], *ARM["left"]), (*CARRY["right"], *CARRY["left"]), strict=True)))

    def _index_joints(self) -> None:
        root = p.getBodyInfo(self.id, physicsClientId=self.client)[0].decode()
        joint: dict[str, int] = {}
        link: dict[str, int] = {root: -1}
        limits: dict[str, tuple[float, float]] = {}
        movable: list[int] = []
        for index in range(p.getNumJoints(self.id, physicsClientId=self.client)):
            info = p.getJointInfo(self.id, index, physicsClientId=self.client)
            name, lower, upper = info[1].decode(), info[8], info[9]
            joint[name], link[info[12].decode()] = index, index
            limits[name] = (lower, upper) if upper > lower else (-math.pi, math.pi)  # PyBullet: continuous is 0, -1
            if info[2] != p.JOINT_FIXED:
                movable.append(index)
        self.joint, self.link = MappingProxyType(joint), MappingProxyType(link)
        self.limits, self.movable = MappingProxyType(limits), tuple(movable)

    def collision_links(self) -> dict[str, int]:
        """Return name and index of every link with a collision shape."""
        shapes = {
            name: p.getCollisionShapeData(self.id, index, physicsClientId=self.client)
            for name, index in self.link.items()
        }
        return {name: self.link[name] for name, data in shapes.items() if data}

    def checked_pairs(self) -> tuple[tuple[int, int], ...]:
        """Return the pairs of links, by index, whose contact is a self-collision: those that the SRDF enables."""
        disabled = {
            frozenset((entry.get("link1"), entry.get("link2")))
            for entry in ET.parse(srdf_path()).getroot().iter("disable_collisions")
        }
        links = sorted(self.collision_links().items(), key=lambda item: item[1])
        return tuple(
            (i, j)
            for k, (first, i) in enumerate(links)
            for second, j in links[k + 1 :]
            if frozenset((first, second)) not in disabled
        )

    def _filter_self_collision(self) -> None:
        checked = frozenset(self.checked_pairs())
        indices = sorted(self.collision_links().values())
        for k, i in enumerate(indices):
            for j in indices[k + 1 :]:
                on = int((i, j) in checked)
                p.setCollisionFilterPair(self.id, self.id, i, j, on, physicsClientId=self.client)

    def set_joints(self, values: Mapping[str, float]) -> None:
        """Set joint values (rad or m), at rest."""
        indices, rest = [self.joint[name] for name in values], [[0.0]] * len(values)
        positions = [[value] for value in values.values()]
        p.resetJointStatesMultiDof(self.id, indices, positions, rest, physicsClientId=self.client)

    def joints(self, names: Iterable[str]) -> tuple[float, ...]:
        """Return the values of joints (rad or m), in the order of `names`."""
        indices = [self.joint[name] for name in names]
        return tuple(state[0] for state in p.getJointStates(self.id, indices, physicsClientId=self.client))

    def set_state(self, state: RobotState) -> None:
        """Set torso, head and arms to the encoder values of a state."""
        self.set_joints({TORSO: state.torso})
        self.set_joints(dict(zip(HEAD, state.head, strict=True)))
        self.set_arm("right", state.right_arm)
        self.set_arm("left", state.left_arm)

    def state(self) -> RobotState:
        """Return the exact encoder values of all joints but the base."""
        pan, tilt = self.joints(HEAD)
        return RobotState(
            torso=self.joints([TORSO])[0], head=(pan, tilt), right_arm=self.arm("right"), left_arm=self.arm("left")
        )

    def set_arm(self, hand: Hand, values: Iterable[float]) -> None:
        """Set the seven joint values of a hand's arm (rad)."""
        self.set_joints(dict(zip(ARM[hand], values, strict=True)))

    def arm(self, hand: Hand) -> Joints7:
        """Return the seven joint values of a hand's arm (rad)."""
        a, b, c, d, e, f, g = self.joints(ARM[hand])
        return (a, b, c, d, e, f, g)

    def set_base(self, world_T_base: Pose2) -> None:
        """Set the pose of `base_footprint` on the floor."""
        self.set_joints(dict(zip(BASE, world_T_base, strict=True)))

    def base(self) -> Pose2:
        """Return world_T_base, theta in [-pi, pi)."""
        x, y, theta = self.joints(BASE)
        return (x, y, wrap_half_open(theta))

    def set_gripper(self, hand: Hand, opening_rad: float) -> None:
        """Set all four finger joints to an angle; 0 is closed. PyBullet ignores `<mimic>`, so each joint is set."""
        roots = {f"{hand[0]}_gripper_{name}_joint": 0.0 for name in _ROOTS}
        self.set_joints(dict.fromkeys(FINGERS[hand], opening_rad) | roots)

    def gripper_gap(self, hand: Hand) -> float:
        """Return the distance between the fingertips' hulls [m], negative if they overlap."""
        left, right = (self.link[f"{hand[0]}_gripper_{side}_finger_tip_link"] for side in ("l", "r"))
        points = p.getClosestPoints(
            self.id, self.id, 1.0, linkIndexA=left, linkIndexB=right, physicsClientId=self.client
        )
        return float(min(point[8] for point in points))

    def link_pose(self, name: str) -> tuple[Vector3, Quaternion]:
        """Return position and orientation (xyzw) of a link's frame in the world."""
        state = p.getLinkState(self.id, self.link[name], computeForwardKinematics=True, physicsClientId=self.client)
        return tuple(state[4]), tuple(state[5])

    def tool_pose(self, hand: Hand) -> tuple[Vector3, Quaternion]:
        """Return position and orientation (xyzw) of the tool frame in the world; x points along the fingers."""
        return self.link_pose(TOOL_FRAME[hand])

    def world_T_tool(self, hand: Hand) -> Pose4:
        """Return the tool frame as an upright pose: exact while the fingers are horizontal."""
        (x, y, z), turn = self.tool_pose(hand)
        return (x, y, z, heading(turn))

    def camera_pose(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the camera's position, shape (3,), and rotation world_R_camera, shape (3, 3); x is forward."""
        position, turn = self.link_pose(CAMERA_FRAME)
        matrix = np.reshape(p.getMatrixFromQuaternion(turn), (3, 3))
        return np.array(position), matrix

    def _head_offsets(self) -> tuple[Vector3, Vector3, Vector3]:
        """Return torso-to-pan, pan-to-tilt and tilt-to-camera offsets; at zero, all these frames are parallel."""
        names = ("torso_lift_link", "head_pan_link", "head_tilt_link", CAMERA_FRAME)
        torso, pan, tilt, camera = (np.array(self.link_pose(name)[0]) for name in names)
        return tuple(pan - torso), tuple(tilt - pan), tuple(camera - tilt)

    def look_at(self, point_world: Vector3) -> tuple[float, float]:
        """Return pan and tilt (rad), within their limits, that turn the optical axis through a point in the world.

        The solution is exact within the limits: the optical axis is a line at a fixed distance from two perpendicular
        joint axes.
        """
        torso_pan, pan_tilt, tilt_camera = self._head
        torso, turn = self.link_pose("torso_lift_link")
        dx, dy, dz = np.subtract(point_world, torso)
        theta = heading(turn)
        x = math.cos(theta) * dx + math.sin(theta) * dy - torso_pan[0]
        y = -math.sin(theta) * dx + math.cos(theta) * dy - torso_pan[1]
        pan = math.atan2(y, x) - _asin((pan_tilt[1] + tilt_camera[1]) / math.hypot(x, y))
        ahead = math.cos(pan) * x + math.sin(pan) * y - pan_tilt[0]
        up = dz - torso_pan[2] - pan_tilt[2]
        tilt = _asin(tilt_camera[2] / math.hypot(ahead, up)) - math.atan2(up, ahead)
        return self._clip(HEAD[0], wrap_half_open(pan)), self._clip(HEAD[1], wrap_half_open(tilt))

    def _clip(self, joint: str, value: float) -> float:
        lower, upper = self.limits[joint]
        return min(max(value, lower), upper)


def _asin(value: float) -> float:
    """Return the arc sine of a value clipped to [-1, 1]; points near the axis may give a value just beyond."""
    return math.asin(min(1.0, max(-1.0, value)))

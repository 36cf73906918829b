"""The robot in a rerun recording: its meshes, moved by recorded joints, or by the belief if none are recorded."""

import math
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import rerun as rr
from foxglove_schemas_protobuf.JointStates_pb2 import JointStates

from skolem.traces.messages import HANDS, Belief, Hand
from skolem.traces.messages.poses import quaternion_xyzw
from skolem.traces.scene.rows import Rows, When
from skolem.traces.scene.shapes import WORLD, Xyz, Xyzw, placed, product


@dataclass(frozen=True, slots=True)
class RobotModel:
    """A robot's description and the names of the joints in a belief.

    Attributes:
        urdf: The description; mesh paths are relative to its folder, its root is fixed in the world.
        base_link: Its base; detections are relative to it.
        base: Joints that move the base along x, along y, and turn it.
        torso: Joint that lifts the torso.
        head: Joints that pan and tilt the head.
        arm: Seven joints of each arm.
    """

    urdf: Path
    base_link: str
    base: tuple[str, str, str]
    torso: str
    head: tuple[str, str]
    arm: Mapping[Hand, tuple[str, ...]]


class Robot:
    """Gathers joint values and sends them as transforms between links."""

    def __init__(self, rows: Rows, model: RobotModel) -> None:
        """Send the meshes.

        Args:
            rows: Rows of the recording.
            model: The robot's model.
        """
        self._rows, self._model = rows, model
        self._tree = rr.urdf.UrdfTree.from_file_path(
            model.urdf, entity_path_prefix="robot", static_transform_entity_path="robot/fixed"
        )
        self._tree.log_urdf_to_recording(recording=rows.stream)
        root = rr.Transform3D(parent_frame=WORLD, child_frame=self._tree.root_link().name)
        rows.static("robot/root", root)
        self._joints = _downwards(self._tree)
        self._values: dict[str, list[tuple[When, float]]] = defaultdict(list)
        self._recorded = False

    def joints(self, message: JointStates, when: When) -> None:
        """Take in recorded joint values; from then on the belief's are not used."""
        self._recorded = True
        for joint in message.joints:
            self._move(joint.name, joint.position, when)

    def believed(self, belief: Belief, when: When) -> None:
        """Take in the joint values and the base of a belief, unless the true ones are recorded."""
        if self._recorded:
            return
        for name, value in self._values_of(belief).items():
            self._move(name, value, when)

    def limbs(self, belief: Belief) -> list[tuple[Xyz, Xyz]]:
        """Return the start of each link of the believed robot and of the links after it, world frame [m]."""
        values, found = self._values_of(belief), []
        frames: dict[str, tuple[Xyz, Xyzw]] = {self._tree.root_link().name: ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))}
        of_robot = {self._model.base_link}
        for joint in self._joints:
            start, turn = frames[joint.parent_link]
            offset, turned_by = _moved(joint, values.get(joint.name, 0.0))
            frames[joint.child_link] = placed(start, turn, offset), product(turn, turned_by)
            if joint.parent_link in of_robot:
                of_robot.add(joint.child_link)
                found.append((start, frames[joint.child_link][0]))
        return found

    def _values_of(self, belief: Belief) -> dict[str, float]:
        """Return the joint values of a belief, its base included."""
        model, state = self._model, belief.robot
        names = (*model.base, model.torso, *model.head, *(name for hand in HANDS for name in model.arm[hand]))
        values = (*belief.world_T_base, state.torso, *state.head, *state.right_arm, *state.left_arm)
        return dict(zip(names, values, strict=True))

    def _move(self, name: str, value: float, when: When) -> None:
        """Keep a joint value until it is sent."""
        self._values[name].append((when, value))

    def flush(self) -> None:
        """Send the kept joint values."""
        for name, values in self._values.items():
            joint = self._tree.get_joint_by_name(name)
            if joint is not None and values:
                columns = joint.compute_transform_columns([value for _, value in values], clamp=False)
                self._rows.send(f"robot/joints/{name}", [when for when, _ in values], columns)
        self._values.clear()


def _downwards(tree: rr.urdf.UrdfTree) -> list[rr.urdf.UrdfJoint]:
    """Return the joints of a tree, each after the one above it."""
    below: dict[str, list[rr.urdf.UrdfJoint]] = defaultdict(list)
    for joint in tree.joints():
        below[joint.parent_link].append(joint)
    found, links = [], [tree.root_link().name]
    for link in links:
        found += below[link]
        links += [joint.child_link for joint in below[link]]
    return found


def _moved(joint: rr.urdf.UrdfJoint, value: float) -> tuple[Xyz, Xyzw]:
    """Return the child's frame in the parent's at a joint value [m or rad]: offset and quaternion xyzw."""
    roll, pitch, yaw = joint.origin_rpy
    turn = product(quaternion_xyzw(yaw), product(_about((0.0, 1.0, 0.0), pitch), _about((1.0, 0.0, 0.0), roll)))
    if joint.joint_type == "prismatic":
        x, y, z = joint.axis
        return placed(joint.origin_xyz, turn, (value * x, value * y, value * z)), turn
    return joint.origin_xyz, product(turn, _about(joint.axis, value))


def _about(axis: Xyz, angle: float) -> Xyzw:
    """Return the quaternion xyzw of a turn about a unit vector."""
    x, y, z = (math.sin(angle / 2.0) * part for part in axis)
    return x, y, z, math.cos(angle / 2.0)

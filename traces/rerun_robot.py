"""The robot in a rerun recording: its meshes, moved by recorded joints, or by the belief where there are none."""

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import rerun as rr
from foxglove_schemas_protobuf.JointStates_pb2 import JointStates

from skolem.traces.messages import HANDS, Belief, Hand
from skolem.traces.rerun_rows import Rows, When
from skolem.traces.rerun_shapes import WORLD


@dataclass(frozen=True, slots=True)
class RobotModel:
    """A robot's description and the names of the joints that a belief speaks of.

    Attributes:
        urdf: The description; mesh paths are relative to its folder, its root stands still in the world.
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
            rows: Of the recording.
            model: What the robot looks like.
        """
        self._rows, self._model = rows, model
        self._tree = rr.urdf.UrdfTree.from_file_path(
            model.urdf, entity_path_prefix="robot", static_transform_entity_path="robot/fixed"
        )
        self._tree.log_urdf_to_recording(recording=rows.stream)
        root = rr.Transform3D(parent_frame=WORLD, child_frame=self._tree.root_link().name)
        rows.static("robot/root", root)
        self._values: dict[str, list[tuple[When, float]]] = defaultdict(list)
        self._recorded = False

    def joints(self, message: JointStates, when: When) -> None:
        """Take in recorded joint values; from then on the belief's are not needed."""
        self._recorded = True
        for joint in message.joints:
            self._move(joint.name, joint.position, when)

    def believed(self, belief: Belief, when: When) -> None:
        """Take in the joint values that a belief holds, and its base, unless the true ones are recorded."""
        if self._recorded:
            return
        model, state = self._model, belief.robot
        names = (*model.base, model.torso, *model.head, *(name for hand in HANDS for name in model.arm[hand]))
        values = (*belief.world_T_base, state.torso, *state.head, *state.right_arm, *state.left_arm)
        for name, value in zip(names, values, strict=True):
            self._move(name, value, when)

    def _move(self, name: str, value: float, when: When) -> None:
        """Let a joint value wait to be sent."""
        self._values[name].append((when, value))

    def flush(self) -> None:
        """Send the joint values that wait."""
        for name, values in self._values.items():
            joint = self._tree.get_joint_by_name(name)
            if joint is not None and values:
                columns = joint.compute_transform_columns([value for _, value in values], clamp=False)
                self._rows.send(f"robot/joints/{name}", [when for when, _ in values], columns)
        self._values.clear()

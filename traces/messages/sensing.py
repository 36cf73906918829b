"""The answers of the robot: joints, camera and wrist."""

from typing import Literal

from pydantic import Field

from skolem.traces.messages.base import Hand, Joints7, Message, Pose2, Pose4, StepNumber, Upper3x3


class RobotState(Message):
    """What the robot's exact encoders say; the base pose is not among them."""

    torso: float = 0.0
    head: tuple[float, float] = (0.0, 0.0)
    right_arm: Joints7
    left_arm: Joints7


class Detection(Message):
    """One object seen by the camera."""

    base_T_object: Pose4
    covariance: Upper3x3 = Field(
        description="upper triangle of 3x3 over (x, y, theta), tangent space of the detected pose (object frame)"
    )
    type_log_likelihood: dict[str, float]
    rgb: tuple[float, float, float] = Field(description="mean of the cluster's pixels, 0..1")
    points: int


class DepthView(Message):
    """A coarse depth image: what space was seen through, for missed detections and seen regions.

    Pixel (column, row) looks along (1, -u / f, -v / f) in the camera frame (x forward, y left, z up) with
    u = column - columns / 2, v = row + 1 - rows / 2 and f = rows / 2 / tan(fovy / 2).
    """

    base_T_camera: tuple[float, float, float, float, float, float, float] = Field(
        description="x, y, z, quaternion xyzw"
    )
    fovy_rad: float
    columns: int
    rows: int
    depth_mm: tuple[int, ...] = Field(description="row-major distance along the camera's x axis; 0 = no return")


class Wrench(Message):
    """Force at the wrist, tare of the same arm pose subtracted, rotated into the base frame."""

    hand: Hand
    force_newton: tuple[float, float, float] = Field(description="base frame, z up: a held object pulls z down")
    samples: int


class Observation(Message):
    """What the sensors said after an action; with ActionResult the only input of a replay."""

    step: StepNumber
    kind: Literal["look", "weigh", "none"]
    detections: tuple[Detection, ...] = ()
    view: DepthView | None = None
    wrench: Wrench | None = None


class ActionResult(Message):
    """What the robot's own joints say about the action."""

    step: StepNumber
    status: Literal["done", "failed", "stopped_early"]
    robot: RobotState
    odometry: Pose2 | None = Field(default=None, description="start_T_end of the base by its wheels; null: not moved")
    base_T_tool: Pose4 | None = Field(default=None, description="hand frame when the fingers closed or opened")
    gripper_gap_m: float | None = Field(default=None, description="between the fingers after closing or opening")
    gaps_m: dict[Hand, float] = Field(
        default={},
        description="between the fingers of each hand at the end of the action; of a place, before they opened",
    )

"""Models of noise, and the initial belief."""

from pydantic import ConfigDict, Field

from skolem.traces.messages.base import Anchor, Message, Pose2, Pose4, Probability, all_required
from skolem.traces.messages.sensing import RobotState
from skolem.traces.messages.words import ObjectType


class NoiseModel(Message):
    """How sensors and motion err; the simulator draws from one of these, the estimator assumes one."""

    model_config = ConfigDict(json_schema_extra=all_required)

    # the defaults are the values of scenarios/sim1_green.yaml: a Kinect, a PR2's wheels and wrist
    depth_sd_scale: float = Field(default=1.0, description="times the Kinect's axial noise; 0 = exact depth")
    extrinsics_sd_m: float = Field(
        default=0.003, description="rigid error of the camera frame, drawn once per look, each axis"
    )
    extrinsics_sd_rad: float = Field(default=0.004, description="the same in rotation, each axis")
    found: Probability = Field(default=0.9, description="probability that a visible object is detected")
    false_per_look: float = Field(default=0.1, description="expected number of detections without an object")
    type_right: Probability = Field(default=0.95, description="probability that the reported type is the true one")
    colour_gain: float = Field(default=0.83, description="mean observed value over true value: shading")
    colour_sd_rgb: float = Field(default=0.03, description="sd of the mean colour of a detection, each channel")
    odometry_sd_m: float = 0.005
    odometry_sd_per_m: float = 0.02
    odometry_sd_rad: float = 0.01
    odometry_sd_per_rad: float = 0.02
    wrist_sd_newton: float = Field(default=0.4, description="sd of one averaged reading")
    wrist_drift_newton: float = Field(default=0.05, description="sd of the slow bias, drawn once per run")
    grasp_sd_m: float = Field(
        default=0.006, description="how far an object moves in the hand when the fingers close, each axis"
    )
    grasp_sd_rad: float = 0.05
    place_sd_m: float = Field(default=0.003, description="how far an object moves when it is released, each axis")
    place_sd_rad: float = 0.03


class HsvBelief(Message):
    """Independent Gaussians over hue (wrapped), saturation and value (truncated to 0..1)."""

    mean: tuple[float, float, float]
    variance: tuple[float, float, float]


class PriorObject(Message):
    """One object the robot is told of before it starts."""

    anchor: Anchor
    type: dict[str, Probability]
    world_T_object: Pose4
    sd_xy_m: float
    sd_theta_rad: float
    support: Anchor | None = Field(default=None, description="what it is believed to stand on; null: the floor")
    colour: HsvBelief | None = Field(default=None, description="null: the prior of an arbitrary object")
    log_weight: tuple[float, float] | None = Field(default=None, description="mean, variance of ln(kg); null: prior")


class PriorRegion(Message):
    """A region of space the robot may search: the air above the top of a support."""

    anchor: Anchor
    support: Anchor
    height_m: float
    expected_objects: float = Field(description="how many objects nobody has met yet are expected in it, unseen")


class Prior(Message):
    """The initial belief and everything the estimator is told; with the rules it determines the robot's mind."""

    world_T_base: Pose2
    base_sd_xy_m: float
    base_sd_theta_rad: float
    robot: RobotState
    objects: tuple[PriorObject, ...]
    regions: tuple[PriorRegion, ...] = ()
    types: dict[str, ObjectType]
    type: dict[str, Probability] = Field(
        default={}, description="of an arbitrary object; empty: each graspable type alike"
    )
    colour: HsvBelief = Field(description="of an arbitrary object")
    log_weight: tuple[float, float] = Field(description="mean, variance of ln(kg) of an arbitrary object")
    noise: NoiseModel = Field(description="what the robot believes of its sensors, right or wrong")

"""The vocabulary of everything that crosses a border between folders.

Frozen models, imported by every folder and importing none. Each message that a trace records stands in the topic table
at the end with its class: INPUT (fed to a replay), DERIVED (regenerated and compared), TRUTH (the simulator's, never
read by the robot) or PERF (ignored).

Units are SI and radians. A pose `a_T_b` maps coordinates of frame b to frame a. `Pose2` is (x, y, theta); `Pose4` is
(x, y, z, theta): an upright object on its stable face. The origin of an object is the centre of its base face.
"""

import json
from typing import Annotated, Final, Literal

from pydantic import BaseModel, ConfigDict, Field

SCHEMA_VERSION = 1
TICKS_PER_SECOND = 240
GRAVITY = 9.81  # m/s^2: what is felt at a wrist, per kg

Anchor = Annotated[str, Field(pattern=r"^(_[a-z]+\d+_|[a-z][A-Za-z0-9_]*)$", description="internal name of an object")]
Hand = Literal["right", "left"]
HANDS: tuple[Hand, ...] = ("right", "left")
SENSING_HAND: Hand = "right"  # the only wrist with a force-torque sensor
Probability = Annotated[float, Field(ge=0.0, le=1.0)]
MicroNats = Annotated[int, Field(ge=0, le=50_000_000, description="-ln p in millionths, capped at 50 nats")]
Step = Annotated[int, Field(ge=0, description="number of actions executed before")]
Pose2 = Annotated[tuple[float, float, float], Field(description="x, y [m], theta [rad]")]
Pose4 = Annotated[tuple[float, float, float, float], Field(description="x, y, z [m], theta [rad]")]
Joints7 = Annotated[
    tuple[float, float, float, float, float, float, float],
    Field(description="shoulder pan, lift, upper-arm roll, elbow flex, forearm roll, wrist flex, wrist roll [rad]"),
]


class Message(BaseModel):
    """Base of every message: frozen, strict types, no unknown field, no NaN or infinity.

    Validators are built when a message of the type is first made or read: a command uses about half of the types.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False, defer_build=True)

    def canonical(self) -> bytes:
        """Return the one byte string for this value: sorted keys, no spaces, UTF-8."""
        return canonical(self.model_dump(mode="json"))


def canonical(values: object) -> bytes:
    """Return the one byte string for plain values."""
    return json.dumps(values, sort_keys=True, separators=(",", ":"), allow_nan=False, ensure_ascii=False).encode()


# ---------------------------------------------------------------- words: what types and properties mean


class ObjectType(Message):
    """One of the finite set of object types.

    A box and a cylinder have the outer size (x, y, z); a table's size is its footprint and the height of its top.
    """

    shape: Literal["box", "cylinder", "table"]
    size_m: tuple[float, float, float]
    graspable: bool


class TypeIs(Message):
    """The property of being of one type."""

    quantity: Literal["type"] = "type"
    type: str


class HsvVolume(Message):
    """The property of having a colour in a box of hue, saturation, value, each 0..1; hue wraps if low > high."""

    quantity: Literal["colour"] = "colour"
    hue: tuple[float, float]
    saturation: tuple[float, float]
    value: tuple[float, float]

    def contains(self, hsv: tuple[float, float, float]) -> bool:
        """Return whether a colour (hue, saturation, value, each 0..1) is in the volume, borders included."""
        hue, saturation, value = hsv
        low, high = self.hue
        around = low <= hue <= high if low <= high else hue >= low or hue <= high
        within = self.saturation[0] <= saturation <= self.saturation[1]
        return around and within and self.value[0] <= value <= self.value[1]


class WeightInterval(Message):
    """The property of weighing at least `at_least_kg` and, if given, less than `below_kg`."""

    quantity: Literal["weight"] = "weight"
    at_least_kg: float
    below_kg: float | None = None


Meaning = TypeIs | HsvVolume | WeightInterval
Quantity = Literal["pose", "type", "colour", "weight"]


# ---------------------------------------------------------------- models of noise and the initial belief


class NoiseModel(Message):
    """How sensors and motion err; the simulator draws from one of these, the estimator assumes one."""

    depth_sd_scale: float = Field(description="times the Kinect's axial noise; 0 = exact depth")
    extrinsics_sd_m: float = Field(description="rigid error of the camera frame, drawn once per look, each axis")
    extrinsics_sd_rad: float = Field(description="the same in rotation, each axis")
    found: Probability = Field(description="probability that a visible object is detected")
    false_per_look: float = Field(description="expected number of detections without an object")
    type_right: Probability = Field(description="probability that the reported type is the true one")
    colour_gain: float = Field(description="mean observed value over true value: shading")
    colour_sd_rgb: float = Field(description="sd of the mean colour of a detection, each channel")
    odometry_sd_m: float
    odometry_sd_per_m: float
    odometry_sd_rad: float
    odometry_sd_per_rad: float
    wrist_sd_newton: float = Field(description="sd of one averaged reading")
    wrist_drift_newton: float = Field(description="sd of the slow bias, drawn once per run")
    grasp_sd_m: float = Field(description="how far an object moves in the hand when the fingers close, each axis")
    grasp_sd_rad: float
    place_sd_m: float = Field(description="how far an object moves when it is released, each axis")
    place_sd_rad: float


class HsvBelief(Message):
    """Independent Gaussians over hue (wrapped), saturation and value (truncated to 0..1)."""

    mean: tuple[float, float, float]
    variance: tuple[float, float, float]


class RobotState(Message):
    """What the robot's exact encoders say; the base pose is not among them."""

    torso: float = 0.0
    head: tuple[float, float] = (0.0, 0.0)
    right_arm: Joints7
    left_arm: Joints7


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


class Limits(Message):
    """Counts after which a run gives up; never seconds."""

    steps: Annotated[int, Field(gt=0, description="executed actions")]
    expansions: Annotated[int, Field(gt=0, description="per call of the regression")]
    hierarchy_depth: Annotated[int, Field(ge=12, description="layers of the plan stack")]
    min_plan_probability: Probability
    repeats: Annotated[int, Field(gt=0, description="of one action without success, before it is given up")] = 10
    same_looks: Annotated[int, Field(gt=0, description="in vain from one place, before the next is from elsewhere")] = 3
    plan_changes: Annotated[int, Field(gt=0, description="of the plan stack in one decision")] = 100
    optimal: Annotated[
        bool, Field(description="take more time, so that no plan at all is likelier than the one found")
    ] = False


class RunStart(Message):
    """What a run was made of."""

    schema_version: int = SCHEMA_VERSION
    scenario: str
    scenario_sha256: str
    rules_sha256: dict[str, str]
    robot_sha256: str
    world: Literal["pybullet", "symbolic"]
    seed: int
    goal: str
    limits: Limits
    ticks_per_second: int = TICKS_PER_SECOND


# ---------------------------------------------------------------- actions


class MoveBase(Message):
    """Drive along a path of base poses, each in the frame of the base where the path starts."""

    kind: Literal["move_base"] = "move_base"
    start_T_waypoint: tuple[Pose2, ...]


class LookAt(Message):
    """Turn the head and take a picture."""

    kind: Literal["look_at"] = "look_at"
    pan: float
    tilt: float


class Pick(Message):
    """Open, follow `approach` and `reach`, close the fingers, follow `lift`, then `carry`."""

    kind: Literal["pick"] = "pick"
    hand: Hand
    approach: tuple[Joints7, ...] = Field(description="from the present arm configuration to the pregrasp")
    reach: tuple[Joints7, ...] = Field(description="straight to the grasp")
    lift: tuple[Joints7, ...] = Field(description="straight up with the object")
    carry: tuple[Joints7, ...] = Field(description="to the carry pose")
    tool_T_object: Pose4 = Field(description="where the object is planned to be in the hand")


class Place(Message):
    """Follow `approach` and `lower` with the object, open the fingers, follow `retreat`, then `carry`."""

    kind: Literal["place"] = "place"
    hand: Hand
    approach: tuple[Joints7, ...]
    lower: tuple[Joints7, ...]
    retreat: tuple[Joints7, ...]
    carry: tuple[Joints7, ...]


class Weigh(Message):
    """Hold still and read the force at the wrist."""

    kind: Literal["weigh"] = "weigh"
    hand: Hand


Command = Annotated[MoveBase | LookAt | Pick | Place | Weigh, Field(discriminator="kind")]


class Action(Message):
    """One primitive action: what the planner calls it, and the command that carries it out."""

    step: Step
    op: str = Field(description="the rule's operator and arguments, for people")
    args: tuple[str, ...] = Field(description="anchors the action is about: object, then support")
    command: Command


# ---------------------------------------------------------------- what comes back


class Detection(Message):
    """One object seen by the camera."""

    base_T_object: Pose4
    covariance: tuple[float, float, float, float, float, float] = Field(
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

    step: Step
    kind: Literal["look", "weigh", "none"]
    detections: tuple[Detection, ...] = ()
    view: DepthView | None = None
    wrench: Wrench | None = None


class ActionResult(Message):
    """What the robot's own joints say about the action."""

    step: Step
    status: Literal["done", "failed", "stopped_early"]
    robot: RobotState
    odometry: Pose2 | None = Field(default=None, description="start_T_end of the base by its wheels; null: not moved")
    base_T_tool: Pose4 | None = Field(default=None, description="hand frame when the fingers closed or opened")
    gripper_gap_m: float | None = Field(default=None, description="between the fingers after closing or opening")


# ---------------------------------------------------------------- belief


class ObjectBelief(Message):
    """Everything believed of one anchor."""

    exists: Probability
    type: dict[str, Probability]
    world_T_object: Pose4 = Field(description="mean; while held: where the hand carries it")
    covariance: tuple[float, float, float, float, float, float] = Field(
        description="marginal, upper triangle of 3x3 over (x, y, theta), object frame"
    )
    support: Anchor | None = None
    in_hand: Hand | None = None
    tool_T_object: Pose4 | None = Field(default=None, description="grasp, while held")
    colour: HsvBelief
    colour_seen: bool = Field(default=False, description="false: still the prior")
    log_weight: tuple[float, float] = Field(description="mean, variance of ln(kg)")
    weighed: bool = Field(default=False, description="false: still the prior")


class RegionBelief(Message):
    """What is known of the contents of a region."""

    support: Anchor
    height_m: float
    seen: Probability = Field(description="BContents: the part seen, known objects taken out")
    hidden: Probability = Field(description="share of the positions where an object could still be hidden")
    unseen_mm: tuple[tuple[int, int, int], ...] = Field(
        default=(), description="some points of the unseen part, frame of the support, millimetres"
    )


class IdentityChange(Message):
    """Two anchors turned out to be of one object, or one to have been two."""

    version: int = Field(description="number of events applied before")
    kind: Literal["merged", "split"]
    anchor: Anchor = Field(description="whose name goes on")
    other: Anchor | None = Field(default=None, description="merged: the anchor that was of the same object")


class Belief(Message):
    """A snapshot of the whole belief: all that the reasoner, the geometry and the viewer may know."""

    step: Step
    version: int = Field(description="number of events applied")
    world_T_base: Pose2
    base_covariance: tuple[float, float, float, float, float, float] = Field(
        description="as in ObjectBelief, base frame"
    )
    robot: RobotState
    anchors: tuple[str, ...] = Field(description="in order of introduction")
    objects: dict[str, ObjectBelief]
    regions: dict[str, RegionBelief] = {}
    identity: tuple[IdentityChange, ...] = Field(default=(), description="what turned out so far about who is who")
    keys: tuple[str, ...] = Field(description="row order of joint_covariance, three rows (x, y, theta) each")
    joint_covariance: tuple[float, ...] = Field(description="upper triangle, tangent space (body frame) of each key")


# ---------------------------------------------------------------- reasoning


class PlanStep(Message):
    """One step of a plan on the stack."""

    op: str
    level: int
    concrete: int = Field(description="the level at which every precondition is demanded")
    primitive: bool = Field(description="carried out by the robot; false: an inference")
    cost: MicroNats
    subgoal: tuple[str, ...] = Field(description="fluents to hold after the step, sorted")
    preimage: tuple[str, ...] = Field(description="fluents under which the step may be taken, sorted")


PlanCause = Literal[
    "start",
    "refine",
    "skipped_forward",
    "fell_back",
    "preimage_lost",
    "bind_skolem",
    "refused",
    "done",
    "giveup",
]


class Plan(Message):
    """The plan stack, logged whenever it changes."""

    step: Step
    cause: PlanCause
    false_fluents: tuple[str, ...] = Field(default=(), description="which fluents of the lost pre-images are false now")
    layers: tuple[tuple[PlanStep, ...], ...] = Field(description="top first; a layer refines one step of the one above")
    current: tuple[int, ...] = Field(default=(), description="index of the chosen step, per layer")


class RememberedStep(PlanStep):
    """A step with all the reasoner needs to go on with it."""

    instance: str = Field(description="the rule instance itself, as a term")
    called: str = Field(description="the operation it counts as, as a term")
    executes: str | None = Field(description="the primitive that carries it out, as a term; null: an inference")


class Memory(Message):
    """What the reasoner remembers when a decision begins: with the belief, all that the decision depends on."""

    step: Step
    layers: tuple[tuple[RememberedStep, ...], ...] = Field(description="the plan stack, top first")
    current: tuple[int, ...] = Field(description="index of the chosen step, per layer")
    executed: RememberedStep | None = Field(description="the step that was carried out last, if it is yet to be judged")
    failures: dict[str, int] = Field(description="how often in a row a step did not do what it should, by instance")
    in_vain: dict[str, int] = Field(default={}, description="the same since the robot last moved, by command")
    objections: dict[str, str] = Field(
        default={}, description="why the robot cannot do such a step at all, by instance"
    )


class Candidate(Message):
    """A rule instance offered at the first expansion of a search, or rejected there."""

    op: str
    cost: MicroNats
    rejected: str | None = Field(default=None, description="reason code and the fluent that caused it; null: offered")


class Decision(Message):
    """One search: what was asked, what was offered, what was chosen and what it took."""

    step: Step
    belief_version: int
    subgoal: tuple[str, ...]
    candidates: tuple[Candidate, ...] = Field(description="sorted by (cost, op)")
    plan: tuple[str, ...] = Field(description="operators in execution order; empty: no plan")
    cost: MicroNats
    within: float | None = Field(
        default=None, description="at most this many times the cost of the best plan; 1: optimal; null: not known"
    )
    expansions: int
    clingo_calls: int
    ground_atoms: int


class Denotation(Message):
    """Whom the robot takes to be meant, at each decision."""

    step: Step
    probability: dict[str, dict[Anchor, Probability]] = Field(
        description="P(Den) by description of the goal (e1, e2, ..), then by anchor"
    )


class Geometry(Message):
    """One geometric question and its answer."""

    step: Step
    query: str
    belief_version: int
    answer: Command | None = None
    blockers: tuple[Anchor, ...] | None = Field(default=None, description="of a question what stands in the way")


class Chain(Message):
    """Hash chain over INPUT and DERIVED messages: equal strings mean that two runs agree up to this step."""

    step: Step
    chain: str


RunStatus = Literal["goal_achieved", "goal_unachievable", "limit_reached", "error", "interrupted"]


class RunEnd(Message):
    """Why the run ended and what the robot believes of its goal."""

    status: RunStatus
    steps: int
    reason: str
    goal_probability: Probability = Field(description="of the best candidate")
    anchor: Anchor | None = Field(default=None, description="the object that denotes, or the best candidate")
    conjuncts: dict[str, Probability] = Field(default={}, description="of that object: P of each fluent and property")
    regions: dict[str, Probability] = Field(default={}, description="how much of each region has been seen")


# ---------------------------------------------------------------- truth


class TrueObject(Message):
    """What an object of the simulated world really is."""

    id: str
    type: str
    world_T_object: Pose4
    hsv: tuple[float, float, float]
    kg: float
    on: str | None = None
    in_hand: Hand | None = None


class TrueState(Message):
    """The simulated world: for verdicts and viewers, never for the robot."""

    step: Step
    world_T_base: Pose2
    objects: tuple[TrueObject, ...]
    sha256: str = Field(description="of joint and body positions and velocities, little-endian float64")


class Verdict(Message):
    """Whether the goal, read against the true world, holds."""

    true: bool
    witness: str | None = Field(default=None, description="a true object that makes it so")


class Perf(Message):
    """Wall time by part; the only place where a clock is read."""

    step: Step
    milliseconds: dict[str, float]


INPUT: Final = "INPUT"
DERIVED: Final = "DERIVED"
TRUTH: Final = "TRUTH"
PERF: Final = "PERF"
TopicClass = Literal["INPUT", "DERIVED", "TRUTH", "PERF"]
JSON_TOPICS: dict[str, tuple[type[Message], TopicClass]] = {
    "/run/start": (RunStart, INPUT),
    "/prior": (Prior, INPUT),
    "/belief": (Belief, DERIVED),
    "/memory": (Memory, DERIVED),
    "/plan": (Plan, DERIVED),
    "/decision": (Decision, DERIVED),
    "/denotation": (Denotation, DERIVED),
    "/geometry": (Geometry, DERIVED),
    "/action": (Action, DERIVED),
    "/action/result": (ActionResult, INPUT),
    "/obs": (Observation, INPUT),
    "/chain": (Chain, DERIVED),
    "/run/end": (RunEnd, DERIVED),
    "/truth/state": (TrueState, TRUTH),
    "/truth/verdict": (Verdict, TRUTH),
    "/perf": (Perf, PERF),
}
PROTOBUF_TOPICS: dict[str, tuple[str, TopicClass]] = {
    "/robot/joint_states": ("foxglove.JointStates", TRUTH),
    "/tf": ("foxglove.FrameTransforms", TRUTH),
    "/camera/rgb": ("foxglove.CompressedImage", TRUTH),
    "/camera/depth": ("foxglove.RawImage", TRUTH),
    "/camera/info": ("foxglove.CameraCalibration", TRUTH),
    "/log": ("foxglove.Log", PERF),
}
CLASS_OF: dict[str, TopicClass] = {t: c for t, (_, c) in JSON_TOPICS.items()} | {
    t: c for t, (_, c) in PROTOBUF_TOPICS.items()
}

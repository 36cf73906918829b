from .actions import (
    Action as Action,
    Command as Command,
    LookAt as LookAt,
    MoveBase as MoveBase,
    Pick as Pick,
    Place as Place,
    Weigh as Weigh,
)
from .activities import Activity as Activity
from .base import (
    GRAVITY as GRAVITY,
    HANDS as HANDS,
    SCHEMA_VERSION as SCHEMA_VERSION,
    SENSING_HAND as SENSING_HAND,
    TICKS_PER_SECOND as TICKS_PER_SECOND,
    Anchor as Anchor,
    Hand as Hand,
    Joints7 as Joints7,
    Message as Message,
    MicroNats as MicroNats,
    Pose2 as Pose2,
    Pose4 as Pose4,
    Probability as Probability,
    StepNumber as StepNumber,
    Upper3x3 as Upper3x3,
    WorldName as WorldName,
    canonical as canonical,
)
from .belief import (
    Belief as Belief,
    IdentityChange as IdentityChange,
    ObjectBelief as ObjectBelief,
    RegionBelief as RegionBelief,
)
from .likeliest import likeliest as likeliest
from .prior import (
    HsvBelief as HsvBelief,
    NoiseModel as NoiseModel,
    Prior as Prior,
    PriorObject as PriorObject,
    PriorRegion as PriorRegion,
)
from .reasoning import (
    DROPPED as DROPPED,
    Candidate as Candidate,
    Decision as Decision,
    Denotation as Denotation,
    Geometry as Geometry,
    Memory as Memory,
    Plan as Plan,
    PlanCause as PlanCause,
    PlanStep as PlanStep,
    RememberedStep as RememberedStep,
)
from .relations import Relation as Relation, Strangers as Strangers
from .run import (
    Chain as Chain,
    Evaluation as Evaluation,
    Limits as Limits,
    Perf as Perf,
    RunEnd as RunEnd,
    RunStart as RunStart,
    RunStatus as RunStatus,
)
from .sensing import (
    ActionResult as ActionResult,
    DepthView as DepthView,
    Detection as Detection,
    Observation as Observation,
    RobotState as RobotState,
    Wrench as Wrench,
)
from .topics import (
    CLASS_OF as CLASS_OF,
    DERIVED as DERIVED,
    INPUT as INPUT,
    JSON_TOPICS as JSON_TOPICS,
    PERF as PERF,
    PROTOBUF_TOPICS as PROTOBUF_TOPICS,
    TRUTH as TRUTH,
    TopicClass as TopicClass,
)
from .truth import Displaced as Displaced, TrueObject as TrueObject, TrueState as TrueState, Verdict as Verdict
from .words import (
    ColourMeaning as ColourMeaning,
    HsvUnion as HsvUnion,
    HsvVolume as HsvVolume,
    Meaning as Meaning,
    ObjectType as ObjectType,
    Quantity as Quantity,
    TypeIs as TypeIs,
    TypeIsNot as TypeIsNot,
    WeightInterval as WeightInterval,
)

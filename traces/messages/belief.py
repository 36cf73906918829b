"""The belief, which is recorded at each step."""

from typing import Literal

from pydantic import Field

from skolem.traces.messages.base import Anchor, Hand, Message, Pose2, Pose4, Probability, StepNumber, Upper3x3
from skolem.traces.messages.prior import HsvBelief
from skolem.traces.messages.sensing import RobotState


class ObjectBelief(Message):
    """Everything believed of one anchor."""

    exists: Probability
    type: dict[str, Probability]
    world_T_object: Pose4 = Field(description="mean; while held: where the hand carries it")
    covariance: Upper3x3 = Field(description="marginal, upper triangle of 3x3 over (x, y, theta), object frame")
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

    step: StepNumber
    version: int = Field(description="number of events applied")
    world_T_base: Pose2
    base_covariance: Upper3x3 = Field(description="as in ObjectBelief, base frame")
    robot: RobotState
    anchors: tuple[str, ...] = Field(description="in order of introduction")
    objects: dict[str, ObjectBelief]
    regions: dict[str, RegionBelief] = {}
    identity: tuple[IdentityChange, ...] = Field(default=(), description="what turned out so far about who is who")
    keys: tuple[str, ...] = Field(description="row order of joint_covariance, three rows (x, y, theta) each")
    joint_covariance: tuple[float, ...] = Field(description="upper triangle, tangent space (body frame) of each key")

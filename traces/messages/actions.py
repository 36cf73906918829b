"""Commands of the robot."""

from typing import Annotated, Literal

from pydantic import Field

from skolem.traces.messages.base import Hand, Joints7, Message, Pose2, Pose4, StepNumber


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

    step: StepNumber
    op: str = Field(description="the rule's operator and arguments, for people")
    args: tuple[str, ...] = Field(description="anchors the action is about: object, then support")
    command: Command

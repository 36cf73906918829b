"""Believed objects as the planner has them: standing somewhere, or carried."""

from dataclasses import dataclass

from skolem.traces.messages import Hand, ObjectType, Pose4


@dataclass(frozen=True, slots=True)
class Standing:
    """A believed object that no hand holds.

    Attributes:
        anchor: Its name.
        type: Its most likely type.
        world_T_object: Mean pose.
        spread_m: How much wider its body is on every side.
        doubt_m: How much wider it is before a moving arm, the margin not counted; tables too.
        own_m: How far beside its place among the other things it may be.
        body: In the physics client.
        support: Anchor of what it stands on, if known.
    """

    anchor: str
    type: ObjectType
    world_T_object: Pose4
    spread_m: float
    doubt_m: float
    own_m: float
    body: int
    support: str | None


@dataclass(frozen=True, slots=True)
class Carried:
    """A believed object in a hand."""

    hand: Hand
    anchor: str
    type: ObjectType
    tool_T_object: Pose4
    body: int

"""Believed objects of the planner: standing ones and carried ones."""

from dataclasses import dataclass

from skolem.traces.messages import Hand, ObjectType, Pose4


@dataclass(frozen=True, slots=True)
class Standing:
    """A believed object that no hand holds.

    Attributes:
        anchor: Its name.
        type: Its most likely type.
        world_T_object: Mean pose.
        spread_m: Widening of its body on every side.
        doubt_m: Widening for a moving arm, without the margin; tables too.
        own_m: Greatest distance from its place among the other objects.
        body: Body in the physics client.
        support: Anchor of its support, if known.
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

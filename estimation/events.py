"""Events: changes of the robot and its objects, as far as the robot can tell. A log of them rebuilds every belief.

An event carries everything that is needed to apply it. For example, it names the anchor of each detection, so that
detections of a log are not assigned again. Events are messages: frozen, validated, with one canonical JSON form.
"""

from collections.abc import Iterable
from typing import Annotated, Literal

from pydantic import ConfigDict, Field, TypeAdapter

from skolem.traces.messages import (
    Anchor,
    DepthView,
    Detection,
    Hand,
    Message,
    Pose2,
    Pose4,
    Prior,
    Probability,
    RobotState,
    Upper3x3,
)

Place = tuple[Anchor, float, float, float]  # a support, x and y on its top, and a weight


class Began(Message):
    """The robot began with a prior."""

    kind: Literal["began"] = "began"
    prior: Prior


class Posed(Message):
    """The encoders gave the robot's joints."""

    kind: Literal["posed"] = "posed"
    robot: RobotState


class Moved(Message):
    """The base drove; the sds are those of the true motion around the odometry, in the frame of the end pose."""

    kind: Literal["moved"] = "moved"
    start_T_end: Pose2
    sd_m: float
    sd_rad: float


class Sighting(Message):
    """A detection and its assigned anchor."""

    anchor: Anchor
    new: bool = Field(description="the anchor was made for this detection")
    support: Anchor | None = Field(
        default=None,
        description="of a new anchor, and of one that stood nowhere known: what it stands on; null: the floor",
    )
    camera_T_object: Pose2 = Field(description="in the base frame as the camera had it, error included")
    covariance: Upper3x3 = Field(description="of the sighting alone over (x, y, theta), object frame")
    z: float
    z_sd_m: float
    odds: float = Field(
        description="how many times likelier the detection is with the object than without; new: real than false"
    )
    detection: Detection


class Missed(Message):
    """An anchor without a detection in a look."""

    anchor: Anchor
    p_reported: Probability = Field(description="P(the look reports it | it exists)")
    solid: Probability = Field(
        default=0.0, description="P(it is in sight, and the picture shows something unexplained where it should be)"
    )


class Looked(Message):
    """A picture was taken."""

    kind: Literal["looked"] = "looked"
    camera_covariance: Upper3x3 = Field(
        description="of the error common to all sightings, over (x, y, theta), base frame"
    )
    sightings: tuple[Sighting, ...]
    missed: tuple[Missed, ...]
    view: DepthView | None = Field(default=None, description="which space was seen through")


class Sought(Message):
    """The places of an object with an uncertain place, after a look that did not detect it."""

    kind: Literal["sought"] = "sought"
    anchor: Anchor
    base_T_object: Pose2 = Field(description="where to look for it next")
    covariance: Upper3x3 = Field(description="spread about that over (x, y, theta), object frame")
    support: Anchor = Field(description="what it would rest on there")
    places: tuple[Place, ...]


class Picked(Message):
    """Fingers closed on an object."""

    kind: Literal["picked"] = "picked"
    hand: Hand
    anchor: Anchor
    base_T_tool: Pose4
    tool_T_object: Pose4 = Field(description="as planned")


class PickFailed(Message):
    """Fingers closed on nothing; the object may have been pushed."""

    kind: Literal["pick_failed"] = "pick_failed"
    anchor: Anchor


class Lost(Message):
    """A hand lost an object, which slipped, was taken, or did not come to rest; the sds are those of its place."""

    kind: Literal["lost"] = "lost"
    hand: Hand
    anchor: Anchor
    base_T_tool: Pose4 = Field(description="where the hand was found empty, or let go")
    sd_m: float
    sd_rad: float
    sd_z_m: float


class Gone(Message):
    """A known object is no longer in its place: somebody put it elsewhere, or the robot pushed it off."""

    kind: Literal["gone"] = "gone"
    anchor: Anchor


class Placed(Message):
    """Fingers opened and released an object; the sds are those of its motion at release."""

    kind: Literal["placed"] = "placed"
    hand: Hand
    anchor: Anchor
    base_T_tool: Pose4
    tool_z_object: float = Field(description="height of the object in the hand, metres")
    support: Anchor | None
    sd_m: float
    sd_rad: float


class Weighed(Message):
    """The wrist of a hand measured the weight of the held object."""

    kind: Literal["weighed"] = "weighed"
    anchor: Anchor
    kg: float


class Merged(Message):
    """Two anchors turned out to be of one object, which keeps the name `anchor`."""

    kind: Literal["merged"] = "merged"
    anchor: Anchor
    other: Anchor
    turn: float = Field(description="heading of the other as seen from the first, for which both look alike")
    sd_rad: float = Field(description="of that heading")


class Split(Message):
    """An anchor turned out to have been of two objects, so each of its detections may have been of either."""

    kind: Literal["split"] = "split"
    anchor: Anchor
    sd_m: float = Field(description="how far from where it was believed the object may be, each axis")
    sd_rad: float


class Consolidated(Message):
    """The past was summed up: no question asks for earlier poses of the base and objects, or for earlier grasps."""

    kind: Literal["consolidated"] = "consolidated"
    forgotten: tuple[Anchor, ...] = Field(default=(), description="anchors given up since")


Event = Annotated[
    Began
    | Posed
    | Moved
    | Looked
    | Sought
    | Picked
    | PickFailed
    | Lost
    | Gone
    | Placed
    | Weighed
    | Merged
    | Split
    | Consolidated,
    Field(discriminator="kind"),
]
EVENT: TypeAdapter[Event] = TypeAdapter(Event, config=ConfigDict(defer_build=True))


def canonical_order(detections: Iterable[Detection]) -> tuple[Detection, ...]:
    """Return detections sorted by pose, colour, likelihoods and points, so that the sensor's order has no effect."""

    def key(detection: Detection) -> tuple[object, ...]:
        numbers = (*detection.base_T_object, *detection.rgb)
        return (tuple(round(n, 9) for n in numbers), sorted(detection.type_log_likelihood.items()), detection.points)

    return tuple(sorted(detections, key=key))

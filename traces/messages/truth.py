"""The simulated world as it is. The robot never reads these."""

from pydantic import Field

from skolem.traces.messages.base import Hand, Message, Pose2, Pose4, StepNumber


class TrueObject(Message):
    """What an object of the simulated world really is."""

    id: str
    type: str
    world_T_object: Pose4
    hsv: tuple[float, float, float]
    kg: float
    on: str | None = None
    in_hand: Hand | None = None


class Displaced(Message):
    """An object that the robot displaced without intent."""

    id: str
    distance_m: float = Field(description="of its place after the action from that before; of several: their sum")


class TrueState(Message):
    """The simulated world: for verdicts and viewers, never for the robot."""

    step: StepNumber
    world_T_base: Pose2
    objects: tuple[TrueObject, ...]
    sha256: str = Field(description="of joint and body positions and velocities, little-endian float64")
    displaced: tuple[Displaced, ...] = Field(
        default=(), description="without intent, by the last action: of what no hand held before or after it"
    )


class Verdict(Message):
    """Whether the goal, read against the true world, holds."""

    true: bool
    witness: str | None = Field(default=None, description="a true object that makes it so")
    displaced: tuple[Displaced, ...] = Field(
        default=(), description="without intent, in the whole run; each object once, by name"
    )

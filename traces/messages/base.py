"""The base of every message, a frozen model with one canonical text; its units, scalars and poses.

Units are SI and radians. A pose `a_T_b` maps coordinates of frame b to frame a. `Pose2` is (x, y, theta); `Pose4` is
(x, y, z, theta): an upright object on its stable face. The origin of an object is the centre of its base face.
"""

import json
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

SCHEMA_VERSION = 1
TICKS_PER_SECOND = 240
GRAVITY = 9.81  # m/s^2: what is felt at a wrist, per kg
Anchor = Annotated[str, Field(pattern=r"^(_[a-z]+\d+_|[a-z][A-Za-z0-9_]*)$", description="internal name of an object")]
WorldName = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_.-]*$", description="name of the kind of world")]
Hand = Literal["right", "left"]
HANDS: tuple[Hand, ...] = ("right", "left")
SENSING_HAND: Hand = "right"  # the only wrist with a force-torque sensor
Probability = Annotated[float, Field(ge=0.0, le=1.0)]
MicroNats = Annotated[int, Field(ge=0, le=50_000_000, description="-ln p in millionths, capped at 50 nats")]
StepNumber = Annotated[int, Field(ge=0, description="number of actions executed before")]
Pose2 = Annotated[tuple[float, float, float], Field(description="x, y [m], theta [rad]")]
Pose4 = Annotated[tuple[float, float, float, float], Field(description="x, y, z [m], theta [rad]")]
Upper3x3 = tuple[float, float, float, float, float, float]  # of a symmetric 3x3 matrix the upper triangle, row by row
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
    """Return the canonical bytes of plain values: sorted keys, no spaces, UTF-8."""
    return json.dumps(values, sort_keys=True, separators=(",", ":"), allow_nan=False, ensure_ascii=False).encode()


def all_required(schema: dict[str, Any]) -> None:
    """Require every field in a model's JSON schema, without defaults: a recorded message has all of its fields."""
    for field in schema["properties"].values():
        field.pop("default", None)
    schema["required"] = list(schema["properties"])

"""The sizes that numbers of a scenario may have, each with its reason.

The bounds keep computations within what integers of 32 bits in the rules, grids and floats hold; and they are wide
enough for every room that a robot works in. A number beyond them is a slip: of unit, of digit, or of sign.
"""

from dataclasses import dataclass
from typing import Annotated, Any, Final

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

MOST_THINGS: Final = 100  # objects of the world, or of the prior
MOST_REGIONS: Final = 20
MOST_MOVES: Final = 1_000  # disturbances
MOST_FILES: Final = 50  # rule files
MOST_KG: Final = 100.0
MOST_HELD_KG: Final = 10.0  # by friction between the fingers, which press with about 55 N each


MOST_OF_LIMITS: Final = {  # greater counts fill memory and disk before they are reached
    "steps": 10_000,
    "expansions": 100_000,
    "hierarchy_depth": 100,
    "repeats": 10_000,
    "same_looks": 10_000,
    "plan_changes": 10_000,
}


class LimitsWithin:
    """The upper bounds of the counts of `limits`, for the JSON Schema; `checks` refuses what is beyond them."""

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Return the JSON Schema of limits, with their upper bounds."""
        found = handler(schema)
        counts = handler.resolve_ref_schema(found)["properties"]
        for name, most in MOST_OF_LIMITS.items():
            counts[name]["maximum"] = most
        return found


@dataclass(frozen=True, slots=True)
class Between:
    """The bounds of a number, for the reader of scenarios and for the JSON Schema.

    Attributes:
        least: The least number that is allowed.
        most: The greatest number that is allowed.
        why: Why no other number makes sense, with the unit.
    """

    least: float
    most: float
    why: str

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Return the schema of the number, followed by the check."""
        return core_schema.no_info_after_validator_function(self._checked, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Return the JSON Schema of the number, with its bounds and their reason."""
        return handler(schema) | {"minimum": self.least, "maximum": self.most, "$comment": self.why}

    def _checked(self, number: float) -> float:
        """Return the number if it is within the bounds."""
        if self.least <= number <= self.most:
            return number
        bounds = {"least": _shown(self.least), "most": _shown(self.most), "why": self.why}
        raise PydanticCustomError("out_of_bounds", "expected {least} to {most}: {why}", bounds)


def _shown(number: float) -> str:
    return str(number) if isinstance(number, int) else f"{number:g}"


Metres = Annotated[
    float,
    Field(strict=True),
    Between(-100.0, 100.0, "metres; the map is one floor of a building, with its origin inside"),
]
Radians = Annotated[
    float, Field(strict=True), Between(-6.2832, 6.2832, "radians; one turn to either side, more is meant as degrees")
]
Deviation = Annotated[
    float, Field(strict=True), Between(0.0, 10.0, "metres; who knows less than that should not name a place")
]
Turned = Annotated[
    float, Field(strict=True), Between(0.0, 6.2832, "radians; with a whole turn nothing is known of the heading")
]
SensorDeviation = Annotated[
    float, Field(strict=True), Between(0.0, 1.0, "metres, or metres per metre; what errs more is no sensor of a place")
]
SensorTurned = Annotated[
    float,
    Field(strict=True),
    Between(0.0, 1.0, "radians, or radians per radian; what errs more is no sensor of a heading"),
]
Factor = Annotated[float, Field(strict=True), Between(0.0, 100.0, "times the usual error; more hides every object")]
Gain = Annotated[float, Field(strict=True), Between(0.01, 1.0, "a share of the light; with less a picture is black")]
Shade = Annotated[float, Field(strict=True), Between(0.0, 1.0, "parts of a colour run from 0 to 1")]
ColourDeviation = Annotated[
    float,
    Field(strict=True),
    Between(0.001, 10.0, "parts of a colour run from 0 to 1: with more nothing is known of it"),
]
Newtons = Annotated[float, Field(strict=True), Between(0.0, 100.0, "newtons; the fingers hold no more")]
Kilograms = Annotated[
    float,
    Field(strict=True),
    Between(0.001, MOST_KG, "kilograms; a wrist feels no less, and a room holds nothing heavier"),
]
LogDeviation = Annotated[
    float, Field(strict=True), Between(0.001, 3.0, "of ln(kg); with 3 a thing may as well weigh 20 times as much")
]
Height = Annotated[
    float,
    Field(strict=True),
    Between(0.01, 2.0, "metres; the camera sees up to 2.2 m away, and cells are some centimetres"),
]
Expected = Annotated[
    float, Field(strict=True), Between(0.0, 100.0, "a number of objects; more have no place on a table")
]
FalseDetections = Annotated[
    float, Field(strict=True), Between(0.0, 10.0, "detections of nothing in one look; more leave no picture to believe")
]
Torso = Annotated[float, Field(strict=True), Between(0.0, 0.31, "metres; the travel of the torso")]
Step = Annotated[int, Field(strict=True), Between(0, 10_000, "a number of actions; no run takes more")]
Seed = Annotated[int, Field(strict=True), Between(0, 2**63 - 1, "seeds are recorded in 64 bits")]

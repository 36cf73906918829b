"""The meaning of types and properties."""

from typing import Literal

from skolem.traces.messages.base import Message


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

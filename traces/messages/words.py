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


class TypeIsNot(Message):
    """The property of being of any other type."""

    quantity: Literal["type"] = "type"
    type: str


class HsvVolume(Message):
    """The property of having a colour in a box of hue, saturation, value, each 0..1; hue wraps if low > high.

    The lower end of an interval belongs to the box and the upper one does not, unless it is the end of the range: boxes
    side by side share no colour.
    """

    quantity: Literal["colour"] = "colour"
    hue: tuple[float, float]
    saturation: tuple[float, float]
    value: tuple[float, float]

    def contains(self, hsv: tuple[float, float, float]) -> bool:
        """Return whether a colour (hue, saturation, value, each 0..1) is in the box."""
        hue, saturation, value = hsv[0] % 1.0, *hsv[1:]
        low, high = self.hue
        around = low <= hue < high if low <= high else hue >= low or hue < high
        return around and _within(saturation, self.saturation) and _within(value, self.value)

    @property
    def boxes(self) -> "tuple[HsvVolume, ...]":
        """The boxes that make up the colour: this one."""
        return (self,)


class HsvUnion(Message):
    """The property of having a colour in one of several boxes of hue, saturation and value, which share no colour."""

    quantity: Literal["colour"] = "colour"
    boxes: tuple[HsvVolume, ...]

    def contains(self, hsv: tuple[float, float, float]) -> bool:
        """Return whether a colour (hue, saturation, value, each 0..1) is in one of the boxes."""
        return any(box.contains(hsv) for box in self.boxes)


def _within(level: float, span: tuple[float, float]) -> bool:
    return span[0] <= level < span[1] or level == span[1] == 1.0


class WeightInterval(Message):
    """The property of weighing at least `at_least_kg` and, if given, less than `below_kg`."""

    quantity: Literal["weight"] = "weight"
    at_least_kg: float
    below_kg: float | None = None


ColourMeaning = HsvVolume | HsvUnion
Meaning = TypeIs | TypeIsNot | ColourMeaning | WeightInterval
Quantity = Literal["pose", "type", "colour", "weight"]

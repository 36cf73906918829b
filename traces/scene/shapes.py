"""Objects drawn in three dimensions: boxes, cylinders and tables at their poses, and their colours."""

import colorsys
from collections.abc import Sequence
from typing import Final, Literal

import rerun as rr

from skolem.traces.messages import ObjectType, Pose4
from skolem.traces.messages.poses import quaternion_xyzw
from skolem.traces.scene.rows import Rows, When

Rgba = tuple[int, int, int, int]
Xyz = tuple[float, float, float]
Xyzw = tuple[float, float, float, float]
WORLD: Final = "world"
FRAME: Final = rr.CoordinateFrame(WORLD)
GREY: Final[Xyz] = (0.0, 0.0, 0.85)  # colour of objects whose colour is unknown
OUTLINE: Final[Rgba] = (255, 190, 90, 255)  # colour of regions
WOOD: Final[Xyz] = (0.09, 0.38, 0.60)
_TOP_M, _LEG_M, _INSET_M = 0.04, 0.04, 0.03  # thickness of a table's top, width of its legs, their inset
_LINE_M: Final = 0.002
_HUES = (  # upper end of each hue
    (0.04, "red"),
    (0.11, "orange"),
    (0.20, "yellow"),
    (0.45, "green"),
    (0.54, "cyan"),
    (0.71, "blue"),
    (0.92, "violet"),
    (1.00, "red"),
)
_COLOURLESS: Final = 0.2  # saturation or value below which a colour is a grey


def rgba(hsv: Sequence[float], alpha: int = 255) -> Rgba:
    """Return a colour (hue wraps; saturation and value are cut to 0..1) in bytes."""
    hue, saturation, value = hsv[0] % 1.0, *(min(1.0, max(0.0, part)) for part in hsv[1:])
    red, green, blue = (round(255 * part) for part in colorsys.hsv_to_rgb(hue, saturation, value))
    return red, green, blue, alpha


def colour_word(hsv: Sequence[float]) -> str:
    """Return the common name of a colour; the robot's own words are in its rules."""
    hue, saturation, value = hsv[0] % 1.0, hsv[1], hsv[2]
    if value < _COLOURLESS:
        return "black"
    if saturation < _COLOURLESS:
        return "grey"
    return next(word for below, word in _HUES if hue <= below)


def rotated(turn: Xyzw, point: Xyz) -> Xyz:
    """Return a point turned by a quaternion xyzw."""
    qx, qy, qz, qw = turn
    x, y, z = point
    tx, ty, tz = 2.0 * (qy * z - qz * y), 2.0 * (qz * x - qx * z), 2.0 * (qx * y - qy * x)
    return (
        x + qw * tx + qy * tz - qz * ty,
        y + qw * ty + qz * tx - qx * tz,
        z + qw * tz + qx * ty - qy * tx,
    )


def product(one: Xyzw, other: Xyzw) -> Xyzw:
    """Return the quaternion xyzw that turns first by `other` and then by `one`."""
    (a, b, c, d), (x, y, z, w) = one, other
    return (
        d * x + a * w + b * z - c * y,
        d * y + b * w + c * x - a * z,
        d * z + c * w + a * y - b * x,
        d * w - a * x - b * y - c * z,
    )


def placed(position: Xyz, turn: Xyzw, point: Xyz) -> Xyz:
    """Return a point of a frame in world coordinates."""
    x, y, z = rotated(turn, point)
    return position[0] + x, position[1] + y, position[2] + z


def point_on(world_T_object: Pose4, point: Xyz) -> Xyz:
    """Return a point of an upright object in world coordinates."""
    return placed(world_T_object[:3], quaternion_xyzw(world_T_object[3]), point)


class Shapes:
    """Draws objects; an object that changes its shape, or is erased, leaves nothing behind."""

    def __init__(self, rows: Rows) -> None:
        """Start with an empty picture."""
        self._rows = rows
        self._drawn: dict[str, str] = {}

    def draw(
        self,
        entity: str,
        when: When,
        kind: ObjectType,
        position: Xyz,
        turn: Xyzw,
        colour: Rgba,
        fill: Literal["solid", "majorwireframe"],
    ) -> None:
        """Draw an object of a type, its origin (the centre of its base face) at a position in the world [m]."""
        self._keep(entity, when, "cylinder" if kind.shape == "cylinder" else "box")
        if kind.shape == "cylinder":
            (width, depth, height) = kind.size_m
            shape: rr.AsComponents = rr.Cylinders3D(
                lengths=[height],
                radii=[(width + depth) / 4.0],
                centers=[placed(position, turn, (0.0, 0.0, height / 2.0))],
                quaternions=[rr.Quaternion(xyzw=turn)],
                colors=[colour],
                line_radii=_LINE_M,
                fill_mode=fill,
            )
        else:
            parts = _boxes(kind)
            shape = rr.Boxes3D(
                half_sizes=[half for half, _ in parts],
                centers=[placed(position, turn, centre) for _, centre in parts],
                quaternions=[rr.Quaternion(xyzw=turn)] * len(parts),
                colors=[colour] * len(parts),
                radii=_LINE_M,
                fill_mode=fill,
            )
        self._rows.add(f"{entity}/{self._drawn[entity]}", when, shape)

    def erase(self, entity: str, when: When) -> None:
        """Stop drawing an object."""
        self._keep(entity, when, "")

    def _keep(self, entity: str, when: When, kind: str) -> None:
        """Clear an entity's drawings of other kinds of shapes."""
        before = self._drawn.get(entity, "")
        if before not in ("", kind):
            nothing = rr.Boxes3D(half_sizes=[]) if before == "box" else rr.Cylinders3D(lengths=[], radii=[])
            self._rows.add(f"{entity}/{before}", when, nothing)
        if kind and f"{entity}/{kind}" not in self._drawn:
            self._rows.static(f"{entity}/{kind}", FRAME)
            self._drawn[f"{entity}/{kind}"] = kind
        self._drawn[entity] = kind


def _boxes(kind: ObjectType) -> list[tuple[Xyz, Xyz]]:
    """Return half sizes and centres of the boxes of an object, in its frame."""
    x, y, z = kind.size_m
    if kind.shape != "table":
        return [((x / 2.0, y / 2.0, z / 2.0), (0.0, 0.0, z / 2.0))]
    leg_z = (z - _TOP_M) / 2.0
    dx, dy = x / 2.0 - _INSET_M - _LEG_M / 2.0, y / 2.0 - _INSET_M - _LEG_M / 2.0
    top = ((x / 2.0, y / 2.0, _TOP_M / 2.0), (0.0, 0.0, z - _TOP_M / 2.0))
    legs = [((_LEG_M / 2.0, _LEG_M / 2.0, leg_z), (i * dx, j * dy, leg_z)) for i in (-1, 1) for j in (-1, 1)]
    return [top, *legs]

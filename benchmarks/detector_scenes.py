"""Tabletop scenes that are hard to see: crowded, touching, hidden, alike, lit from the side, high and low."""

import colorsys
import math
from dataclasses import dataclass

import numpy as np
from numpy.random import PCG64, Generator, SeedSequence

from skolem.estimation.visibility import outline_radius as radius
from skolem.sim.detector.cloud import Cloud, cloud_from_depth
from skolem.sim.physics import camera
from skolem.sim.robot import bodies
from skolem.sim.space.pinhole import Frame
from skolem.sim.truth.noise import Purpose, extrinsic_error, noisy_depth, stream
from skolem.traces.messages import NoiseModel, ObjectType, Pose4

Vector3 = tuple[float, float, float]
TABLE_X, TABLE_SIZE = 1.1, (0.7, 1.1)
EYE: Vector3 = (0.0, 0.0, 1.45)
HUES = (0.0, 0.12, 0.33, 0.5, 0.63, 0.85)
AREA = ((0.88, -0.36), (1.32, 0.36))  # corners of the used part of the table, which is wholly in the image
STOOD_APART_M, CLUTTER_M = 0.12, 0.03  # gaps between outlines
LOW, HALVINGS = 0.6, 7  # share of the tallest object's height that it can hide from above; steps of the search
TRIES = 4000  # most attempts to place an object at random


@dataclass(frozen=True, slots=True)
class Thing:
    """An object of a scene: type, pose and colour."""

    type: str
    world_T_object: Pose4
    hsv: Vector3


@dataclass(frozen=True, slots=True)
class Scene:
    """The objects on a table, the light, and the objects to find.

    Attributes:
        condition: Name of the difficulty.
        number: Number of the scene; with the condition it determines every draw.
        things: All objects on the table.
        asked: Indices of the objects to find.
        table_m: Height of the table's top.
        light: Direction towards the light; None: from above.
    """

    condition: str
    number: int
    things: tuple[Thing, ...]
    asked: tuple[int, ...]
    table_m: float
    light: Vector3 | None = None


def scattered(
    condition: str,
    number: int,
    types: dict[str, ObjectType],
    count: int,
    gap_m: float,
    table_m: float = 0.68,
    light: Vector3 | None = None,
) -> Scene:
    """Return objects at random positions, at least a gap apart; in clutter each has a neighbour at exactly that gap."""
    draws = Generator(PCG64(SeedSequence([number, *condition.encode()])))
    things: list[Thing] = []
    for _ in range(TRIES):
        if len(things) == count:
            break
        kind = sorted(types)[int(draws.integers(len(types)))]
        theta = float(draws.uniform(-math.pi / 2.0, math.pi / 2.0))
        if things and gap_m < STOOD_APART_M:
            other = things[int(draws.integers(len(things)))]
            reach, bearing = radius(types[kind]) + radius(types[other.type]) + gap_m, draws.uniform(0.0, math.tau)
            x = other.world_T_object[0] + reach * math.cos(bearing)
            y = other.world_T_object[1] + reach * math.sin(bearing)
        else:
            x, y = (float(v) for v in draws.uniform(*AREA))
        if _is_free(x, y, kind, things, types, gap_m):
            hsv = (HUES[int(draws.integers(len(HUES)))], 0.9, 0.8)
            things.append(Thing(kind, (float(x), float(y), table_m, theta), hsv))
    return Scene(condition, number, tuple(things), tuple(range(len(things))), table_m, light)


def _is_free(x: float, y: float, kind: str, things: list[Thing], types: dict[str, ObjectType], gap_m: float) -> bool:
    (x0, y0), (x1, y1) = AREA
    if not (x0 <= x <= x1 and y0 <= y <= y1):
        return False
    return all(
        math.dist((x, y), other.world_T_object[:2]) >= radius(types[kind]) + radius(types[other.type]) + gap_m - 1e-9
        for other in things
    )


def touching(number: int, types: dict[str, ObjectType]) -> Scene:
    """Return two objects side by side without a gap; a box touches with the middle of a long face."""
    draws = Generator(PCG64(SeedSequence([number, 1])))
    kinds = [sorted(types)[int(draws.integers(len(types)))] for _ in range(2)]
    bearing, x, y = (float(v) for v in draws.uniform((0.0, 1.0, -0.2), (math.pi, 1.2, 0.2)))
    reach = sum(types[kind].size_m[0] / 2.0 for kind in kinds)
    places = ((x, y, 0.68, bearing), (x + reach * math.cos(bearing), y + reach * math.sin(bearing), 0.68, bearing))
    hues = draws.choice(HUES, 2, replace=False).tolist()
    things = [Thing(kind, at, (hue, 0.9, 0.8)) for kind, at, hue in zip(kinds, places, hues, strict=True)]
    return Scene("touching", number, tuple(things), (0, 1), 0.68)


def hidden(number: int, share: float, types: dict[str, ObjectType]) -> Scene:
    """Return a low object and a tall one that hides the given share of it, found by shifting the tall one aside.

    The share is one of the pixels that the object has when it stands alone. Only the hidden object is to be found.
    """
    draws = Generator(PCG64(SeedSequence([number, round(100 * share)])))
    tallest = max(sorted(types), key=lambda name: types[name].size_m[2])
    low = [name for name in sorted(types) if types[name].size_m[2] < LOW * types[tallest].size_m[2]]
    kind = low[int(draws.integers(len(low)))]
    x, y, side = float(draws.uniform(1.1, 1.25)), float(draws.uniform(-0.2, 0.2)), float(draws.choice((-1.0, 1.0)))
    target = Thing(kind, (x, y, 0.68, float(draws.uniform(-1.5, 1.5))), (0.33, 0.9, 0.8))
    before, bearing = radius(types[kind]) + radius(types[tallest]) + CLUTTER_M, math.atan2(y, x)
    alone = _pixels((target,), types)

    def scene(aside: float) -> tuple[Thing, Thing]:
        px = x - before * math.cos(bearing) - side * aside * math.sin(bearing)
        py = y - before * math.sin(bearing) + side * aside * math.cos(bearing)
        return target, Thing(tallest, (px, py, 0.68, 0.0), (0.0, 0.9, 0.8))

    near, far = 0.0, 0.2  # metres aside: most hidden, not hidden
    for _ in range(HALVINGS):
        middle = (near + far) / 2.0
        covered = 1.0 - _pixels(scene(middle), types) / alone
        near, far = (middle, far) if covered > share else (near, middle)
    return Scene(f"{100 * share:.0f} % hidden", number, scene(near), (0,), 0.68)


def _pixels(things: tuple[Thing, ...], types: dict[str, ObjectType]) -> int:
    """Return the number of pixels of the first object."""
    return int((picture(things, types, 0.68).body == 2).sum())


def head(table_m: float) -> Frame:
    """Return a camera frame at the head's height that looks at the middle of the table, level."""
    forward = np.subtract((TABLE_X, 0.0, table_m), EYE) / math.dist((TABLE_X, 0.0, table_m), EYE)
    left = np.cross([0.0, 0.0, 1.0], forward)
    left /= np.linalg.norm(left)
    return Frame(np.array(EYE), np.column_stack([forward, left, np.cross(forward, left)]))


def picture(
    things: tuple[Thing, ...], types: dict[str, ObjectType], table_m: float, light: Vector3 | None = None
) -> camera.Image:
    """Return a rendering; body 0 is the floor, 1 the table, then the objects."""
    client = bodies.connect(gravity=False)
    bodies.floor(client)
    table = ObjectType(shape="table", size_m=(*TABLE_SIZE, table_m), graspable=False)
    bodies.object_body(client, table, (TABLE_X, 0.0, 0.0, 0.0), bodies.WOOD, 0.0)
    for thing in things:
        bodies.object_body(
            client, types[thing.type], thing.world_T_object, (*colorsys.hsv_to_rgb(*thing.hsv), 1.0), 0.0
        )
    image = camera.render(client, head(table_m), light_world=light)
    bodies.disconnect(client)
    return image


def cloud(scene: Scene, types: dict[str, ObjectType], noise: NoiseModel) -> Cloud:
    """Return the noisy cloud of a scene; base and world frame are the same."""
    image = picture(scene.things, types, scene.table_m, scene.light)
    key = scene.number + 1000 * sum(scene.condition.encode())
    depth = noisy_depth(image.depth, noise.depth_sd_scale, stream(0, key, Purpose.DEPTH))
    error = extrinsic_error(noise, stream(0, key, Purpose.EXTRINSICS))
    return cloud_from_depth(depth, camera.exposed(image.rgb, noise.colour_gain), head(scene.table_m), error)

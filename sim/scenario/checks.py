"""Mistakes between the parts of a scenario: names, sums, and objects that cannot stand at their places.

The raw document is checked, not validated models, so that one run reports these mistakes together with those of single
values. An entry that is broken in itself is not compared with others, but its name is known.
"""

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from skolem.sim.scenario.document import Address, nearest
from skolem.sim.scenario.models import REGION_NAME, BasePose, BelievedObject, Disturbance, Place, WorldObject
from skolem.sim.scenario.sizes import MOST_HELD_KG, MOST_KG, MOST_MOVES, MOST_OF_LIMITS
from skolem.sim.space.footprints import Footprint, footprint, overhang, overlaps
from skolem.traces.messages import ObjectType, Pose2
from skolem.traces.messages.likeliest import likeliest
from skolem.traces.messages.poses import compose2

M = TypeVar("M", bound=BaseModel)
Mistake = tuple[Address, str]
Types = Mapping[str, ObjectType]
ROBOT_HALF_M = 0.334  # half the side of the PR2's square base
BASE = "base"  # the name of the robot's own place in its belief
OWN_ANCHOR = "names of the form _o1_ are the robot's own; name it without underscores around"


def mistakes(values: Mapping[str, Any], types: Types) -> Iterator[Mistake]:
    """Yield every mistake between parts of the document, in no particular order."""
    world = _readable(values, ("world",), WorldObject)
    yield from _limits(values)
    yield from _names(values, ("world",))
    yield from _names(values, ("belief", "objects"))
    yield from _regions(values, types)
    yield from _types_of_strangers(values, types)
    yield from _world_types(values, types)
    yield from _supports(values, types)
    yield from _belief(values, types)
    yield from _disturbances(values, world, types)
    yield from _collisions(world, types)
    yield from _robot(values, world, types)


def _limits(values: Mapping[str, Any]) -> Iterator[Mistake]:
    """Yield the counts that no run could reach before memory or disk are full."""
    limits = values.get("limits")
    for name, most in MOST_OF_LIMITS.items():
        count = limits.get(name) if isinstance(limits, dict) else None
        if isinstance(count, int) and count > most:
            yield ("limits", name), f"expected at most {most}: more would fill memory or disk (got {str(count)[:20]})"


def placed(world: Iterable[WorldObject], types: Types) -> dict[str, Pose2]:
    """Return world_T_object, flat, of every object whose type and support are known."""
    objects = {item.id: item for item in world if item.type in types}
    return {name: pose for name, item in objects.items() if (pose := _pose(item.on, item.at, objects)) is not None}


def _pose(on: str | None, at: Place, objects: Mapping[str, WorldObject]) -> Pose2 | None:
    """Return the flat world pose of a place `at` on the table `on`; with None, `at` is in the world."""
    if on is None:
        return at
    return compose2(objects[on].at, at) if on in objects and objects[on].on is None else None


def _rows(values: Mapping[str, Any], address: tuple[str, ...]) -> list[tuple[int, Mapping[str, Any]]]:
    """Return the entries of a list that are mappings, with their index; what is beyond every limit is left out."""
    node: Any = values
    for key in address:
        node = node.get(key) if isinstance(node, dict) else None
    rows = node[:MOST_MOVES] if isinstance(node, list) else []
    return [(i, row) for i, row in enumerate(rows) if isinstance(row, dict)]


def _readable(values: Mapping[str, Any], address: tuple[str, ...], model: type[M]) -> dict[int, M]:
    """Return the entries of a list that are valid in themselves, by index."""
    found = {}
    for i, row in _rows(values, address):
        try:
            found[i] = model.model_validate(row)
        except ValidationError:
            continue
    return found


def _ids(values: Mapping[str, Any], address: tuple[str, ...]) -> list[str]:
    return [row["id"] for _, row in _rows(values, address) if isinstance(row.get("id"), str)]


def _names(values: Mapping[str, Any], address: tuple[str, ...]) -> Iterator[Mistake]:
    yield from _twice(values, address)
    for i, row in _rows(values, address):
        if isinstance(name := row.get("id"), str) and name.startswith("_"):
            yield (*address, i, "id"), OWN_ANCHOR
        elif name == BASE:
            yield (*address, i, "id"), f"'{BASE}' is the robot's own; give the object another name"


def _twice(values: Mapping[str, Any], address: tuple[str, ...]) -> Iterator[Mistake]:
    first: dict[str, int] = {}
    for i, row in _rows(values, address):
        name = row.get("id")
        if isinstance(name, str) and name in first:
            yield (*address, i, "id"), f"'{name}' is already the name of {'.'.join(address)}[{first[name]}]"
        elif isinstance(name, str):
            first[name] = i


def _world_types(values: Mapping[str, Any], types: Types) -> Iterator[Mistake]:
    for i, row in _rows(values, ("world",)):
        kind = row.get("type")
        if isinstance(kind, str) and kind not in types:
            yield ("world", i, "type"), f"no type '{kind}'{nearest(kind, types)}"
        elif isinstance(kind, str) and types[kind].graspable:
            for key in ("hsv", "kg"):
                if row.get(key) is None:
                    yield ("world", i, key), f"a {kind} can be grasped and needs {key}"
            kg = row.get("kg")
            if isinstance(kg, int | float) and MOST_HELD_KG < kg <= MOST_KG:
                yield ("world", i, "kg"), f"a {kind} can be grasped, and fingers hold at most {MOST_HELD_KG:g} kg"


def _supports(values: Mapping[str, Any], types: Types) -> Iterator[Mistake]:
    """Yield supports that do not exist or have no top, in the world and in the disturbances."""
    tables = {row["id"]: row.get("type") for _, row in _rows(values, ("world",)) if isinstance(row.get("id"), str)}
    for part in ("world", "disturbances"):
        for i, row in _rows(values, (part,)):
            on, kind = row.get("on"), tables.get(str(row.get("id")))
            if isinstance(on, str):
                yield from _support((part, i, "on"), on, str(row.get("id")), tables, types)
                if isinstance(kind, str) and kind in types and types[kind].shape == "table":
                    yield (part, i, "on"), f"a {kind} stands on the floor: leave out 'on'"


def _support(address: Address, on: str, name: str, kinds: Mapping[str, Any], types: Types) -> Iterator[Mistake]:
    tables = [other for other, kind in kinds.items() if isinstance(kind, str) and _is_table(kind, types)]
    if on == name:
        yield address, f"'{name}' cannot stand on itself"
    elif on not in kinds:
        yield address, f"no object '{on}'{nearest(on, tables)}"
    elif isinstance(kinds[on], str) and kinds[on] in types and on not in tables:
        yield address, f"'{on}' is a {kinds[on]}, which has no top to stand on{nearest(on, tables)}"


def _is_table(kind: str, types: Types) -> bool:
    return kind in types and types[kind].shape == "table"


def _belief(values: Mapping[str, Any], types: Types) -> Iterator[Mistake]:
    address = ("belief", "objects")
    true_ids = _ids(values, ("world",))
    kinds = _believed_kinds(values)
    for i, row in _rows(values, address):
        yield from _type_shares((*address, i, "type"), row.get("type"), types)
        name, like, at, on = row.get("id"), row.get("like"), row.get("at"), row.get("on")
        if (like is None) == (at is None):
            yield (*address, i), "expected either 'like: world' or 'at: [x, y, theta]'"
        if like == "world" and isinstance(name, str) and name not in true_ids:
            yield (*address, i, "id"), f"like: world, but the world has no object '{name}'{nearest(name, true_ids)}"
        if like == "world" and on is not None:
            yield (*address, i, "on"), "like: world takes the support from the world: leave out 'on'"
        elif isinstance(on, str):
            yield from _support((*address, i, "on"), on, str(name), kinds, types)
            if on in kinds and on not in _ids(values, address)[:i]:
                yield (*address, i, "on"), f"'{on}' must stand before '{name}' in the list"


def _believed_kinds(values: Mapping[str, Any]) -> dict[str, str | None]:
    """Return the most likely type of each object in the prior; None if it cannot be read."""
    address = ("belief", "objects")
    believed = {item.id: item for item in _readable(values, address, BelievedObject).values()}
    kinds: dict[str, str | None] = dict.fromkeys(_ids(values, address))
    return kinds | {name: likeliest(item.type) if item.type else "" for name, item in believed.items()}


def _regions(values: Mapping[str, Any], types: Types) -> Iterator[Mistake]:
    address, kinds = ("belief", "regions"), _believed_kinds(values)
    yield from _twice(values, address)
    for i, row in _rows(values, address):
        if isinstance(name := row.get("id"), str) and name.startswith("_") and not re.match(REGION_NAME, name):
            yield (*address, i, "id"), f"'{name}' is not the name of a region; those have the form _reg1_"
        if isinstance(on := row.get("on"), str):
            yield from _support((*address, i, "on"), on, str(row.get("id")), kinds, types)


def _types_of_strangers(values: Mapping[str, Any], types: Types) -> Iterator[Mistake]:
    priors = values.get("priors")
    shares = priors.get("type") if isinstance(priors, dict) else None
    yield from _type_shares(("priors", "type"), shares, types)
    for kind in shares if isinstance(shares, dict) else ():
        if kind in types and not types[kind].graspable:
            yield ("priors", "type", kind), f"a {kind} cannot be grasped: only such things may be met unannounced"


def _type_shares(address: Address, shares: Any, types: Types) -> Iterator[Mistake]:
    if not isinstance(shares, dict):
        return
    for kind in shares:
        if kind not in types:
            yield (*address, kind), f"no type '{kind}'{nearest(kind, types)}"
    numbers = [share for share in shares.values() if isinstance(share, int | float) and 0 <= share <= 1]
    if len(numbers) == len(shares) and not math.isclose(sum(numbers), 1.0, abs_tol=1e-9):
        yield address, f"probabilities sum to {sum(numbers):g}, expected 1"


def _disturbances(values: Mapping[str, Any], world: Mapping[int, WorldObject], types: Types) -> Iterator[Mistake]:
    objects = {item.id: item for item in world.values()}
    ids = _ids(values, ("world",))
    for i, row in _rows(values, ("disturbances",)):
        name = row.get("id")
        if isinstance(name, str) and name not in ids:
            yield ("disturbances", i, "id"), f"no object '{name}'{nearest(name, ids)}"
    for i, move in _readable(values, ("disturbances",), Disturbance).items():
        item = objects.get(move.id)
        if item is None or item.type not in types:
            continue
        if types[item.type].shape == "table":
            yield ("disturbances", i, "id"), f"'{move.id}' is a {item.type}: only things that can be lifted are moved"
        else:
            moved = item.model_copy(update={"on": move.on, "at": move.at})
            yield from _overhangs(("disturbances", i, "at"), moved, objects, types)


def _collisions(world: Mapping[int, WorldObject], types: Types) -> Iterator[Mistake]:
    """Yield objects that hang over an edge, or overlap an earlier one on the same support."""
    known = {
        i: item for i, item in world.items() if item.type in types and not (item.on and _is_table(item.type, types))
    }
    objects = {item.id: item for item in known.values()}
    poses = placed(known.values(), types)
    covers = {name: footprint(types[objects[name].type], pose) for name, pose in poses.items()}
    for i, item in known.items():
        if item.id not in covers:
            continue
        yield from _overhangs(("world", i, "at"), item, objects, types)
        for j, other in known.items():
            if j < i and other.id != item.id and other.on == item.on and other.id in covers:
                if overlaps(covers[item.id], covers[other.id]):
                    yield ("world", i, "at"), f"'{item.id}' overlaps '{other.id}'"


def _overhangs(
    address: Address, item: WorldObject, objects: Mapping[str, WorldObject], types: Types
) -> Iterator[Mistake]:
    pose = _pose(item.on, item.at, objects)
    if item.on is None or pose is None or not _is_table(objects[item.on].type, types):
        return
    support = objects[item.on]
    beyond = overhang(footprint(types[item.type], pose), footprint(types[support.type], support.at))
    if beyond > 0.0:
        yield address, f"'{item.id}' hangs {100 * beyond:.1f} cm over the edge of '{item.on}'"


def _robot(values: Mapping[str, Any], world: Mapping[int, WorldObject], types: Types) -> Iterator[Mistake]:
    """Yield a mistake for each object on the floor that overlaps the robot's base."""
    robot = values.get("robot")
    try:
        base = BasePose.model_validate(robot.get("base") if isinstance(robot, dict) else None)
    except ValidationError:
        return
    square = Footprint((base.x, base.y, base.theta), (ROBOT_HALF_M, ROBOT_HALF_M), 0.0)
    for item in world.values():
        if item.type in types and item.on is None and overlaps(square, footprint(types[item.type], item.at)):
            yield ("robot", "base"), f"the robot's base overlaps '{item.id}'"

"""Scenario files: a goal, a true world, a prior, and the errors of the sensors.

Reading has two stages, since a scenario's rule files define types: `load_document` gives the YAML and the names of the
rule files, `check` turns the document into a `Scenario` once the types are known. Both raise all faults together.
"""

import json
import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, TypeVar, Union, get_args, get_origin

from numpy.random import PCG64, Generator, SeedSequence
from pydantic import BaseModel, ValidationError

from skolem.sim.scenario.checks import mistakes, placed
from skolem.sim.scenario.document import Address, Document, load_document, nearest, read_document
from skolem.sim.scenario.models import BelievedObject, BelievedRegion, ColourPrior, LogNormal, Scenario, WorldObject
from skolem.sim.truth.bodies import TrueBody
from skolem.traces.errors import Fault, InputError
from skolem.traces.messages import (
    HsvBelief,
    NoiseModel,
    ObjectType,
    Pose2,
    Pose4,
    Prior,
    PriorObject,
    PriorRegion,
    RobotState,
)
from skolem.traces.messages.likeliest import likeliest
from skolem.traces.messages.poses import compose2, wrap_half_open

__all__ = [
    "Document",
    "Scenario",
    "check",
    "load_document",
    "load_scenario",
    "moves_before",
    "prior_of",
    "read_document",
    "schema_text",
    "true_bodies",
]

Types = Mapping[str, ObjectType]
T = TypeVar("T")
GoalFaults = Callable[[str, frozenset[str]], list[tuple[int, str]]]
TABLE_HSV = (0.083, 0.46, 0.65)  # wood, for tables without a colour in the scenario
TABLE_KG = 30.0
PRIOR_STREAM = 100  # differs from all numbers of skolem.sim.truth.noise.Purpose


def _unread(goal: str, names: frozenset[str]) -> list[tuple[int, str]]:
    """Return no faults: the reasoner alone can judge a goal."""
    return []


def load_scenario(
    path: Path, types: Types, overrides: Sequence[str] = (), goal_faults: GoalFaults = _unread
) -> Scenario:
    """Return the scenario in a file.

    Args:
        path: The file.
        types: Every object type of the rules.
        overrides: Changed values, each `a.b=value`.
        goal_faults: As for `check`; by default the goal is not judged.

    Raises:
        InputError: With every fault of the file.
    """
    return check(load_document(path, overrides), types, goal_faults)


def check(document: Document, types: Types, goal_faults: GoalFaults) -> Scenario:
    """Return the scenario of a document.

    Args:
        document: A scenario file read as YAML.
        types: Every object type of the rules.
        goal_faults: Called with the goal's text and the names in the prior; returns (offset, message) pairs.

    Raises:
        InputError: With every fault of the document.
    """
    faults: set[Fault] = set()
    scenario = None
    try:
        scenario = Scenario.model_validate(document.values)
    except ValidationError as error:
        faults |= set(_invalid(document, error))
    faults |= {document.fault(address, message) for address, message in mistakes(document.values, types)}
    faults |= set(_missing_rules(document))
    faults |= set(_goal(document, goal_faults))
    if faults or scenario is None:
        raise InputError(faults)
    return scenario


def schema_text() -> str:
    """Return the JSON Schema of scenario files, for editors."""
    return json.dumps(Scenario.model_json_schema(), indent=1, sort_keys=True) + "\n"


def true_bodies(scenario: Scenario, types: Types) -> tuple[TrueBody, ...]:
    """Return the true bodies at the start, in the order of the file."""
    return tuple(
        TrueBody(
            id=item.id,
            type=item.type,
            world_T_object=_raised(item, placed(scenario.world, types)[item.id], scenario, types),
            hsv=item.hsv or TABLE_HSV,
            kg=item.kg or TABLE_KG,
        )
        for item in scenario.world
    )


def moves_before(scenario: Scenario, types: Types, step: int) -> tuple[tuple[str, Pose4], ...]:
    """Return (id, new world_T_object) of each object that is disturbed just before action number `step`."""
    items = {item.id: item for item in scenario.world}
    moved = [
        items[move.id].model_copy(update={"on": move.on, "at": move.at})
        for move in scenario.disturbances
        if move.before_step == step
    ]
    poses = [placed([*(other for other in scenario.world if other.id != item.id), item], types) for item in moved]
    return tuple((i.id, _raised(i, known[i.id], scenario, types)) for i, known in zip(moved, poses, strict=True))


def prior_of(scenario: Scenario, types: Types, seed: int, robot: RobotState) -> Prior:
    """Return the prior of a run.

    The base and the objects `like: world` are drawn around the truth with the stated deviations, from a stream of their
    own, so that the initial belief is calibrated over seeds. Without noise they are known exactly.

    Args:
        scenario: The scenario.
        types: Every object type.
        seed: Seed of the run.
        robot: The encoder values at the start.
    """
    draw = Generator(PCG64(SeedSequence([seed, 0, PRIOR_STREAM]))).standard_normal
    base, sd = scenario.robot.base, scenario.robot.base_sd
    base_sd = (0.0, 0.0) if scenario.noise == "none" else (sd.xy_m, sd.theta_rad)
    known: dict[str, PriorObject] = {}
    world_T_base = _perturbed((base.x, base.y, base.theta), *base_sd, draw(3).tolist())
    for item in scenario.belief.objects:
        known[item.id] = _prior_object(item, scenario, types, known, draw(3).tolist())
    return Prior(
        world_T_base=world_T_base,
        base_sd_xy_m=base_sd[0],
        base_sd_theta_rad=base_sd[1],
        robot=robot,
        objects=tuple(known.values()),
        regions=tuple(_region(item, scenario) for item in scenario.belief.regions),
        types=_sorted(types),
        type=_sorted(scenario.priors.type or {}),
        colour=_hsv(scenario.priors.colour),
        log_weight=_log_weight(scenario.priors.log_weight),
        noise=believed_noise(scenario),
    )


def _sorted(of_types: Mapping[str, T]) -> dict[str, T]:
    """Return a mapping in the order of a trace, since sums in another order may differ in the last digit."""
    return dict(sorted(of_types.items()))


def believed_noise(scenario: Scenario) -> NoiseModel:
    """Return the noise that the robot believes its sensors have, right or wrong."""
    return (scenario.true_noise if scenario.model == "same" else scenario.model).message()


def _prior_object(
    item: BelievedObject, scenario: Scenario, types: Types, known: Mapping[str, PriorObject], noise: list[float]
) -> PriorObject:
    """Return the prior of one object, given those of the objects before it."""
    defaults = scenario.belief.defaults
    sd_xy = defaults.sd_xy_m if item.sd_xy_m is None else item.sd_xy_m
    sd_theta = defaults.sd_theta_rad if item.sd_theta_rad is None else item.sd_theta_rad
    if item.at is None:
        if scenario.noise == "none":
            sd_xy = sd_theta = 0.0
        body = next(body for body in true_bodies(scenario, types) if body.id == item.id)
        x, y, z, theta = body.world_T_object
        x, y, theta = _perturbed((x, y, theta), sd_xy, sd_theta, noise)
        on = next(true.on for true in scenario.world if true.id == item.id)
        support = on if on in {row.id for row in scenario.belief.objects} else None
    elif item.on is None:
        (x, y, theta), z, support = item.at, 0.0, None
    else:
        under = known[item.on]
        x, y, theta = compose2((*under.world_T_object[:2], under.world_T_object[3]), item.at)
        z, support = types[likeliest(under.type)].size_m[2], item.on
    return PriorObject(
        anchor=item.id,
        type=_sorted(item.type),
        world_T_object=(x, y, z, theta),
        sd_xy_m=sd_xy,
        sd_theta_rad=sd_theta,
        support=support,
        colour=None if item.colour is None else _hsv(item.colour),
        log_weight=None if item.log_weight is None else _log_weight(item.log_weight),
    )


def _region(item: BelievedRegion, scenario: Scenario) -> PriorRegion:
    expected = scenario.priors.objects_per_region if item.objects is None else item.objects
    return PriorRegion(anchor=item.id, support=item.on, height_m=item.height_m, expected_objects=expected)


def _perturbed(world_T_thing: Pose2, sd_xy: float, sd_theta: float, noise: list[float]) -> Pose2:
    """Return the pose moved by standard normal `noise` (x, y, theta) times the deviations."""
    x, y, theta = world_T_thing
    return (x + sd_xy * noise[0], y + sd_xy * noise[1], wrap_half_open(theta + sd_theta * noise[2]))


def _raised(item: WorldObject, world_T_item: Pose2, scenario: Scenario, types: Types) -> Pose4:
    support = next((other for other in scenario.world if other.id == item.on), None)
    x, y, theta = world_T_item
    return (x, y, 0.0 if support is None else types[support.type].size_m[2], theta)


def _hsv(colour: ColourPrior) -> HsvBelief:
    h, s, v = colour.sd
    return HsvBelief(mean=colour.hsv, variance=(h * h, s * s, v * v))


def _log_weight(weight: LogNormal) -> tuple[float, float]:
    return (math.log(weight.median_kg), weight.sigma**2)


def _invalid(document: Document, error: ValidationError) -> Iterator[Fault]:
    """Yield pydantic's errors as faults with positions."""
    for item in error.errors(include_url=False):
        address = _in_document(document, item["loc"])
        got = item["input"]
        if item["type"] == "string_pattern_mismatch" and address[-1] == "id" and str(got).startswith("_"):
            continue  # the check of the prior's names gives a better message
        if item["type"] == "extra_forbidden":
            known = nearest(str(item["loc"][-1]), _keys(item["loc"][:-1]))
            yield document.fault(address, f"no such key{known}", at_key=True)
        elif item["type"] == "missing":
            yield document.fault(address, "missing" if isinstance(item["loc"][-1], str) else "too few values")
        elif item["type"] == "model_type":
            yield document.fault(address, f"expected a mapping with the keys {', '.join(_keys(item['loc']))}")
        else:
            shown = "" if isinstance(got, dict | list) else f" (got {got!r:.60})"
            yield document.fault(address, item["msg"] + shown)


def _in_document(document: Document, loc: tuple[int | str, ...]) -> Address:
    """Return pydantic's location as an address, without the names of union branches, which are not in the file."""
    node: Any = document.values
    address: list[str | int] = []
    for i, key in enumerate(loc):
        there = key in node if isinstance(node, dict) else isinstance(node, list) and key in range(len(node))
        if there:
            node = node[key]
            address.append(key)
        elif i == len(loc) - 1 and isinstance(node, dict):
            address.append(key)  # the missing key
    return tuple(address)


def _keys(loc: tuple[int | str, ...]) -> list[str]:
    """Return the keys that the part of a scenario at `loc` may have."""
    model: type[BaseModel] = Scenario
    for key in loc:
        field = model.model_fields.get(str(key))
        inner = None if field is None else _model_in(field.annotation)
        model = inner or model
    return list(model.model_fields)


def _model_in(annotation: Any) -> type[BaseModel] | None:
    """Return the first model named in an annotation."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    if get_origin(annotation) in (tuple, Union, UnionType, Annotated):
        return next((found for part in get_args(annotation) if (found := _model_in(part)) is not None), None)
    return None


def _missing_rules(document: Document) -> Iterator[Fault]:
    for i, path in enumerate(document.rules):
        if path.suffix != ".lp":
            yield document.fault(("rules", i), "expected the name of an .lp file")
        elif not os.path.isfile(path):
            yield document.fault(("rules", i), f"no such file: {path}")


def _goal(document: Document, goal_faults: GoalFaults) -> Iterator[Fault]:
    goal, belief = document.values.get("goal"), document.values.get("belief")
    if not isinstance(goal, str):
        return
    objects = belief.get("objects") if isinstance(belief, dict) else None
    rows = [row for row in objects if isinstance(row, dict)] if isinstance(objects, list) else []
    known = frozenset(name for row in rows if isinstance(name := row.get("id"), str))
    for offset, message in goal_faults(goal, known):
        yield document.fault(("goal",), message, offset)

"""Sizes of a scenario: every number has bounds in the JSON Schema, and whatever is within them runs."""

import copy
import json
import math
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from hypothesis import HealthCheck, given, seed, settings, strategies as st
from kit.places import ROOT

from skolem.sim.scenario.document import Document, read_document
from skolem.sim.scenario.scenario import schema_text
from skolem.tools.loop.session import run
from skolem.tools.loop.setup import compose
from skolem.traces.errors import InputError

SCHEMA = json.loads(schema_text())
Address = tuple[str | int, ...]


def whole_scenario() -> dict[str, Any]:
    """Return a scenario in which every number that a scenario may have is written out."""
    text = (ROOT / "scenarios" / "sim1_moved.yaml").read_text(encoding="utf-8")
    values: dict[str, Any] = read_document("moved", text).values
    noise = values["noise"] = {**values["noise"]}
    values["model"] = copy.deepcopy(noise)
    values["limits"] |= {"steps": 3, "min_plausible": 1e-3, "min_favourable": 0.5, "repeats": 10, "same_looks": 3}
    values["limits"] |= {"plan_changes": 100}
    values["priors"] |= {"type": {"soda": 1.0}, "objects_per_region": 0.5}
    told = {"sd_xy_m": 0.03, "sd_theta_rad": 0.1, "log_weight": {"median_kg": 0.3, "sigma": 0.6}}
    values["belief"]["objects"][3] |= told | {"colour": {"hsv": [0.5, 0.6, 0.6], "sd": [0.5, 0.3, 0.3]}}
    values["belief"]["objects"].append({"id": "rumour", "type": {"soda": 1.0}, "on": "table3", "at": [0.1, 0.1, 0.0]})
    values["belief"]["regions"] = [{"id": "_reg1_", "on": "table2", "height_m": 0.3, "objects": 0.5}]
    return values


def numbers(node: Any, schema: dict[str, Any], address: Address = ()) -> Iterator[tuple[Address, dict[str, Any]]]:
    """Yield the address and the schema of every number of a scenario."""
    schema = SCHEMA["$defs"][schema["$ref"].rsplit("/", 1)[1]] if "$ref" in schema else schema
    either = schema.get("anyOf") or schema.get("oneOf")
    if either:
        kinds: dict[type, list[str]] = {dict: ["object"], list: ["array"], str: ["string"]}
        kind = kinds.get(type(node), ["number", "integer"])
        schema = next(
            (one for one in either if one.get("type") in kind or ("$ref" in one and isinstance(node, dict))), {}
        )
        yield from numbers(node, schema, address)
    elif isinstance(node, dict):
        for key, value in node.items():
            yield from numbers(
                value, schema.get("properties", {}).get(key) or schema["additionalProperties"], (*address, key)
            )
    elif isinstance(node, list):
        for i, value in enumerate(node):
            inner = schema["prefixItems"][i] if "prefixItems" in schema else schema["items"]
            yield from numbers(value, inner, (*address, i))
    elif isinstance(node, int | float) and not isinstance(node, bool):
        yield address, schema


WHOLE = whole_scenario()
NUMBERS = {address: schema for address, schema in numbers(WHOLE, SCHEMA) if address != ("skolem",)}


def with_values(changed: dict[Address, float]) -> Document:
    values = copy.deepcopy(WHOLE)
    for address, value in changed.items():
        node: Any = values
        for key in address[:-1]:
            node = node[key]
        node[address[-1]] = value
    return read_document("bounds.yaml", json.dumps(values))


SHARES = {address for address in NUMBERS if "type" in address}  # probabilities that sum to 1


def least(schema: dict[str, Any]) -> float:
    low: float = schema["minimum"] if "minimum" in schema else schema["exclusiveMinimum"] + 1
    return low


@st.composite
def sizes(draw: st.DrawFn) -> dict[Address, float]:
    """Return numbers at and around their bounds: one number, or many at once.

    True places are left alone most of the time, since almost all others are refused as overlapping.
    """
    many = st.lists(st.sampled_from([a for a in NUMBERS if "at" not in a and a[1:2] != ("base",)]), max_size=60)
    chosen = draw(st.lists(st.sampled_from(list(NUMBERS)), min_size=1, max_size=1) | many)
    return {address: draw(around_the_bounds(NUMBERS[address])) for address in chosen if address not in SHARES}


def around_the_bounds(schema: dict[str, Any]) -> st.SearchStrategy[float]:
    low, high = least(schema), schema["maximum"]
    if schema["type"] == "integer":
        return st.sampled_from([low, low + 1, high - 1, high, low - 1, high + 1])
    inside = [low, math.nextafter(low, high), low + 1e-9, math.nextafter(high, low), high]
    return st.sampled_from([*inside, math.nextafter(low, -math.inf), math.nextafter(high, math.inf)])


def test_every_number_of_a_scenario_has_a_lower_and_an_upper_bound() -> None:
    assert len(NUMBERS) > 100
    for address, schema in NUMBERS.items():
        assert schema.keys() & {"minimum", "exclusiveMinimum"}, address
        assert "maximum" in schema, address


@pytest.mark.parametrize("address", NUMBERS, ids=lambda address: ".".join(map(str, address)))
def test_a_number_beyond_its_bounds_is_refused_with_its_place(address: Address) -> None:
    for value in (NUMBERS[address]["maximum"] + 1, least(NUMBERS[address]) - 1):
        with pytest.raises(InputError) as caught:
            compose(with_values({address: value}), world="symbolic")
        place = ".".join(map(str, address))
        assert any(fault.at == place for fault in caught.value.faults), str(caught.value)


@seed(0)
@settings(max_examples=30, deadline=None, derandomize=False, suppress_health_check=list(HealthCheck))
@given(sizes())
def test_what_is_at_and_around_the_bounds_is_refused_or_runs_to_a_verdict(changed: dict[Address, float]) -> None:
    steps = {("limits", "steps"): 2, ("limits", "expansions"): 500}
    try:
        setup = compose(with_values(changed | steps), world="symbolic")
    except InputError as refusal:
        assert all(fault.at for fault in refusal.faults)  # noqa: PT017
        return
    with TemporaryDirectory() as folder:
        assert run(setup, Path(folder) / "run.mcap").verdict is not None


def test_a_thing_that_fingers_cannot_hold_is_refused_and_a_heavy_table_is_not() -> None:
    with pytest.raises(InputError, match="fingers hold at most 10 kg"):
        compose(with_values({("world", 3, "kg"): 50.0}), world="symbolic")
    compose(with_values({("world", 0, "kg"): 50.0}), world="symbolic")


def test_a_number_of_thousands_of_digits_is_refused_with_its_place() -> None:
    for digits in ("9" * 3400, "0x" + "f" * 3400):
        for address in ("seed", "limits.steps", "world.3.kg", "belief.objects.0.type.table"):
            values = read_document("digits", json.dumps(WHOLE), [f"{address}={digits}"])
            with pytest.raises(InputError, match=address):
                compose(values, world="symbolic")


ENTRIES = {
    "world": {"id": "a", "type": "soda", "at": [0, 0, 0]},
    "belief.objects": {"id": "a", "type": {"soda": 1.0}, "at": [0, 0, 0]},
    "belief.regions": {"id": "_reg1_", "on": "table1", "height_m": 0.3},
    "rules": "x.lp",
}


@pytest.mark.parametrize("part", ENTRIES)
def test_a_list_with_too_many_entries_is_refused_at_once(part: str) -> None:
    document = read_document("many", json.dumps(WHOLE), [f"{part}={json.dumps([ENTRIES[part]] * 120)}"])
    with pytest.raises(InputError) as refusal:
        compose(document, world="symbolic")
    assert any("should have at most" in fault.message for fault in refusal.value.faults)
    assert len(str(refusal.value)) < 100 * 500  # a hundred faults at most, each with the beginning of the flag alone

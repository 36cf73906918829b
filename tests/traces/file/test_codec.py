import json
import math
from collections.abc import Callable

import pytest
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.JointStates_pb2 import JointStates
from hypothesis import given, strategies as st
from pydantic import ValidationError

from skolem.traces.errors import InternalError
from skolem.traces.file.clock import tick_at, time_ns
from skolem.traces.file.codec import ContentHash, HashChain, decode, encode, schema_bytes
from skolem.traces.messages import (
    CLASS_OF,
    JSON_TOPICS,
    SCHEMA_VERSION,
    Chain,
    Detection,
    HsvBelief,
    Perf,
    Verdict,
    Wrench,
)

finite = st.floats(allow_nan=False, allow_infinity=False)
triple = st.tuples(finite, finite, finite)


@given(st.integers(min_value=0, max_value=10**12))
def test_every_tick_comes_back_from_its_log_time(tick: int) -> None:
    assert tick_at(time_ns(tick)) == tick


def test_a_second_has_240_ticks() -> None:
    assert time_ns(240) == 10**9


@given(st.dictionaries(st.text(st.characters(exclude_categories=["Cs"])), finite))
def test_json_messages_round_trip_through_one_byte_string(milliseconds: dict[str, float]) -> None:
    data = encode("/perf", Perf(step=0, milliseconds=milliseconds))
    again = decode("/perf", data)
    assert again == Perf(step=0, milliseconds=milliseconds)
    assert encode("/perf", again) == data


@given(triple)
def test_canonical_bytes_do_not_depend_on_the_order_of_a_dictionary(values: tuple[float, float, float]) -> None:
    named = dict(zip("abc", values, strict=True))
    backwards = dict(reversed(named.items()))
    assert encode("/perf", Perf(step=1, milliseconds=named)) == encode("/perf", Perf(step=1, milliseconds=backwards))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_nan_and_infinity_are_refused_in_every_kind_of_field(value: float) -> None:
    with pytest.raises(ValidationError, match="finite"):
        Perf(step=0, milliseconds={"sim": value})
    with pytest.raises(ValidationError, match="finite"):
        HsvBelief(mean=(0.1, value, 0.1), variance=(0.1, 0.1, 0.1))
    with pytest.raises(ValidationError, match="finite"):
        Wrench(hand="right", force_newton=(value, 0.0, 0.0), samples=1)


def test_types_are_strict() -> None:
    with pytest.raises(ValidationError):
        Detection.model_validate({"base_T_object": (True, "0.5", 0, 0)})
    with pytest.raises(ValidationError, match="extra"):
        Verdict.model_validate({"true": True, "colour": "green"})


def test_protobuf_messages_round_trip() -> None:
    message = FrameTransforms()
    message.transforms.add(parent_frame_id="world", child_frame_id="base")
    assert decode("/tf", encode("/tf", message)) == message


@pytest.mark.parametrize(("topic", "data"), [("/tf", b"\xff\xff"), ("/perf", b"{}"), ("/perf", b"\xff")])
def test_bytes_that_are_no_message_are_refused(topic: str, data: bytes) -> None:
    with pytest.raises(ValueError, match=r"parsing|validation"):
        decode(topic, data)


@pytest.mark.parametrize(
    ("topic", "message", "expected"),
    [
        ("/nowhere", Verdict(true=True), "no topic '/nowhere'"),
        ("/perf", Verdict(true=True), "/perf carries skolem.Perf, got Verdict"),
        ("/tf", JointStates(), "/tf carries foxglove.FrameTransforms, got JointStates"),
        ("/chain", JointStates(), "/chain carries skolem.Chain, got JointStates"),
    ],
)
def test_a_message_on_the_wrong_topic_is_refused(topic: str, message: Verdict, expected: str) -> None:
    with pytest.raises(InternalError, match=expected):
        encode(topic, message)


def test_every_json_schema_describes_an_object_as_viewers_require() -> None:
    assert {json.loads(schema_bytes(topic))["type"] for topic in JSON_TOPICS} == {"object"}


def test_every_message_type_has_one_topic() -> None:
    models = [model for model, _ in JSON_TOPICS.values()]
    assert len(models) == len(set(models))


def test_schemas_are_those_of_the_schema_version(golden: Callable[[str, str], None]) -> None:
    """Raise SCHEMA_VERSION with any change of a field's name, type or meaning that a released reader would miss."""
    schemas = {topic: json.loads(schema_bytes(topic)) for topic in JSON_TOPICS}
    snapshot = {"SCHEMA_VERSION": SCHEMA_VERSION, "class_of": CLASS_OF, "schemas": schemas}
    golden("message_schemas.json", json.dumps(snapshot, indent=1, sort_keys=True, ensure_ascii=False) + "\n")


def hashes_of(*messages: tuple[str, bytes]) -> ContentHash:
    hashes = ContentHash()
    for sequence, (topic, data) in enumerate(messages):
        hashes.add(topic, data, 0, sequence)
    return hashes


def test_content_hash_passes_over_perf_and_decision_hash_over_truth_too() -> None:
    sensed, true, timed = ("/obs", b"{}"), ("/tf", b"x"), ("/perf", b"{}")
    assert hashes_of(sensed, timed).content == hashes_of(sensed).content
    assert hashes_of(sensed, true).content != hashes_of(sensed).content
    assert hashes_of(sensed, true).decision == hashes_of(sensed).decision


def test_hashes_tell_apart_what_only_differs_in_where_a_part_ends() -> None:
    assert hashes_of(("/obs", b"ab")).content != hashes_of(("/obs", b"a"), ("/obs", b"b")).content


def chain_of(*steps: tuple[tuple[str, bytes], ...]) -> list[str]:
    chain = HashChain()
    links = []
    for step in steps:
        for topic, data in step:
            chain.add(topic, data)
        links.append(chain.close())
    return links


def test_the_chain_agrees_up_to_the_first_differing_step_and_never_after() -> None:
    first, second, other = (("/obs", b"1"),), (("/obs", b"2"),), (("/obs", b"3"),)
    left, right = chain_of(first, second, first), chain_of(first, other, first)
    assert [a == b for a, b in zip(left, right, strict=True)] == [True, False, False]


def test_the_chain_covers_decisions_alone() -> None:
    sensed = ("/obs", b"1")
    own = ("/chain", Chain(step=0, chain="00").canonical())
    assert chain_of((sensed,)) == chain_of((sensed, ("/tf", b"x"), ("/perf", b"{}"), own))

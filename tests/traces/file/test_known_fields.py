"""Fields that an older schema does not know are left out, wherever they stand."""

import json
from typing import Literal

import pytest
from kit.recordings import recorded
from pydantic import BaseModel, Field

from skolem.traces.file.codec import schema_bytes
from skolem.traces.file.known_fields import KnownFields
from skolem.traces.file.reader import Trace
from skolem.traces.messages import JSON_TOPICS


class Leaf(BaseModel):
    kind: Literal["leaf"] = "leaf"
    size: int


class Stem(BaseModel):
    kind: Literal["stem"] = "stem"
    size: float


class Plant(BaseModel):
    best: Leaf | None = None
    named: dict[str, Leaf] = {}
    listed: tuple[tuple[Leaf, ...], ...] = ()
    part: Leaf | Stem | None = Field(default=None, discriminator="kind")
    fixed: tuple[float, float] = (0.0, 0.0)


KNOWN = KnownFields(json.dumps(Plant.model_json_schema()).encode())
OLD, NEW = {"kind": "leaf", "size": 1}, {"kind": "leaf", "size": 1, "new": True}


@pytest.mark.parametrize(
    ("new", "old"),
    [
        ({"later": 1}, {}),
        ({"best": NEW}, {"best": OLD}),
        ({"best": None}, {"best": None}),
        ({"named": {"a": NEW}}, {"named": {"a": OLD}}),
        ({"listed": [[NEW], [NEW, NEW]]}, {"listed": [[OLD], [OLD, OLD]]}),
        ({"part": {"kind": "stem", "size": 0.5, "new": 1}}, {"part": {"kind": "stem", "size": 0.5}}),
        ({"fixed": [1.0, 2.0]}, {"fixed": [1.0, 2.0]}),
    ],
)
def test_later_fields_are_left_out(new: object, old: object) -> None:
    assert KNOWN.of(new) == old


@pytest.mark.parametrize("topic", JSON_TOPICS)
def test_a_message_of_this_version_is_left_as_it_is(topic: str) -> None:
    known = KnownFields(schema_bytes(topic))
    for message in Trace(recorded("illustrative")).messages(topic):
        assert known.of(json.loads(message.data)) == json.loads(message.data)

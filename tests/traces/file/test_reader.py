import tracemalloc
from collections.abc import Callable
from pathlib import Path

import pytest
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from hypothesis import given, strategies as st
from kit.draws import examples
from mcap.writer import Writer

from skolem.traces.errors import TraceError
from skolem.traces.file.codec import CONTENT
from skolem.traces.file.reader import Recorded, Trace
from skolem.traces.file.writer import TraceWriter
from skolem.traces.messages import Observation, Perf, RunStart, TrueObject, TrueState, Verdict

number = st.floats(allow_nan=False, allow_infinity=False)
text = st.text(st.characters(exclude_categories=["Cs"]))
true_object = st.builds(
    TrueObject,
    id=text,
    type=text,
    world_T_object=st.tuples(number, number, number, number),
    hsv=st.tuples(number, number, number),
    kg=number,
    on=st.none() | text,
    in_hand=st.sampled_from(["right", "left", None]),
)
true_state = st.builds(
    TrueState,
    step=st.integers(min_value=0),
    world_T_base=st.tuples(number, number, number),
    objects=st.lists(true_object, max_size=3).map(tuple),
    sha256=text,
)
verdict = st.builds(Verdict, true=st.booleans(), witness=st.none() | text)
written = st.lists(
    st.tuples(st.just("/truth/state"), true_state) | st.tuples(st.just("/truth/verdict"), verdict), max_size=8
)


@pytest.fixture
def trace(tmp_path: Path, record_run: Callable[..., str]) -> Path:
    path = tmp_path / "sample.mcap"
    record_run(path)
    return path


def rewrite(source: Trace, path: Path) -> None:
    run = {k: v for k, v in source.metadata["run"].items() if k != "schema_version"}
    env = source.metadata["env"]
    with TraceWriter(path, attachments=source.attachments, run=run, env=env, profile=True) as writer:
        for recorded in source.messages():
            writer.write(recorded.topic, recorded.message, recorded.tick)


def test_the_last_message_of_a_topic_is_found_from_the_end(trace: Path) -> None:
    every = list(Trace(trace).messages())
    for topic in {recorded.topic for recorded in every}:
        assert Trace(trace).last(topic) == [recorded for recorded in every if recorded.topic == topic][-1]
    assert Trace(trace).last("/camera/rgb") is None


@examples(30)
@given(written)
def test_any_messages_come_back_equal_and_write_the_same_bytes(
    tmp_path_factory: pytest.TempPathFactory, messages: list[tuple[str, TrueState | Verdict]]
) -> None:
    folder = tmp_path_factory.mktemp("round_trip")
    first, second = folder / "first.mcap", folder / "second.mcap"
    with TraceWriter(first, attachments={}, run={}, env={}) as writer:
        for tick, (topic, message) in enumerate(messages):
            writer.write(topic, message, tick)
    trace = Trace(first)
    read = [(recorded.topic, recorded.message) for recorded in trace.messages()]
    assert read[:-1] == messages
    assert [recorded.tick for recorded in trace.messages()][:-1] == list(range(len(messages)))
    rewrite(trace, second)
    assert first.read_bytes() == second.read_bytes()


def test_a_whole_run_read_and_written_again_is_the_same_file(trace: Path, tmp_path: Path) -> None:
    rewrite(Trace(trace), tmp_path / "again.mcap")
    assert trace.read_bytes() == (tmp_path / "again.mcap").read_bytes()


def test_messages_of_one_type_are_decoded_in_order(trace: Path) -> None:
    observations = list(Trace(trace).of(Observation))
    assert [observation.step for observation in observations] == [0, 1, 2]
    assert observations[1].detections[0].base_T_object[0] == 1 / 3 + 1


def test_messages_of_chosen_topics_keep_file_order_at_equal_times(trace: Path) -> None:
    topics = [recorded.topic for recorded in Trace(trace).messages("/obs", "/action", "/tf")]
    assert topics == ["/action", "/tf", "/obs"] * 3


def test_protobuf_messages_are_decoded(trace: Path) -> None:
    last = list(Trace(trace).messages("/tf"))[-1].message
    assert isinstance(last, FrameTransforms)
    assert last.transforms[0].translation.x == 2 / 7


def test_the_trace_carries_what_the_run_was_made_of(trace: Path) -> None:
    assert Trace(trace).attachments["rules/look.lp"].decode() == "% look, Schlüssel\n"
    run, env = {"seed": "7", "schema_version": "1"}, {"python": "3"}
    assert Trace(trace).metadata == {"run": run, "env": env, CONTENT: Trace(trace).hashes.metadata}
    assert next(Trace(trace).of(RunStart)).seed == 7


def test_reading_takes_the_memory_of_a_chunk_not_of_the_file(tmp_path: Path) -> None:
    path = tmp_path / "long.mcap"
    state = TrueState(step=0, world_T_base=(0.0, 0.0, 0.0), objects=(), sha256="x" * 4000)
    with TraceWriter(path, attachments={}, run={}, env={}) as writer:
        for tick in range(4000):
            writer.write("/truth/state", state, tick)
    trace = Trace(path)
    tracemalloc.start()
    total = sum(len(recorded.data) for recorded in trace.messages())
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert total > 16_000_000
    assert peak < 2_000_000


def test_every_flipped_bit_is_noticed_when_the_trace_is_opened(trace: Path) -> None:
    sound = trace.read_bytes()
    for place in [*range(0, len(sound), 97), *range(len(sound) - 60, len(sound))]:
        damaged = bytearray(sound)
        damaged[place] ^= 1 << place % 8
        trace.write_bytes(damaged)
        with pytest.raises(TraceError, match=r"damaged|truncated|not a trace"):
            Trace(trace)


def test_a_file_cut_anywhere_says_truncated_and_what_to_do(trace: Path) -> None:
    sound = trace.read_bytes()
    for size in range(8, len(sound), len(sound) // 20):
        trace.write_bytes(sound[:size])
        with pytest.raises(TraceError, match=r"truncated.*skolem recover"):
            Trace(trace)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b"skolem: 1\n"])
def test_a_file_that_is_no_trace_is_named_so(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "scenario.mcap"
    path.write_bytes(content)
    with pytest.raises(TraceError, match=r"scenario\.mcap: not a trace"):
        Trace(path)


def test_a_missing_file_is_named_so(tmp_path: Path) -> None:
    with pytest.raises(TraceError, match=r"b\.mcap: cannot read the trace: No such file"):
        Trace(tmp_path / "b.mcap")


def foreign_file(path: Path, topic: str, sequence: int, run: dict[str, str]) -> Path:
    """Write a sound MCAP file with one Verdict, as another program could."""
    with path.open("wb") as file:
        mcap = Writer(file, enable_data_crcs=True)
        mcap.start()
        mcap.add_metadata("run", run)
        channel = mcap.register_channel(topic, "json", mcap.register_schema("x", "jsonschema", b"{}"))
        mcap.add_message(channel, 0, b'{"true":"yes"}', 0, sequence)
        mcap.finish()
    return path


def test_a_newer_schema_version_is_refused_with_what_to_do(tmp_path: Path) -> None:
    newer = foreign_file(tmp_path / "a.mcap", "/truth/verdict", 0, {"schema_version": "99"})
    with pytest.raises(TraceError, match="has schema version 99, known is 1; install a newer skolem"):
        Trace(newer)


def test_a_foreign_mcap_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(TraceError, match="names no schema version"):
        Trace(foreign_file(tmp_path / "a.mcap", "/truth/verdict", 0, {}))


def test_an_unknown_topic_is_named(tmp_path: Path) -> None:
    trace = Trace(foreign_file(tmp_path / "a.mcap", "/weather", 0, {"schema_version": "1"}))
    with pytest.raises(TraceError, match="unknown topic /weather"):
        list(trace.messages())


def test_a_missing_message_is_noticed(tmp_path: Path) -> None:
    trace = Trace(foreign_file(tmp_path / "a.mcap", "/truth/verdict", 4, {"schema_version": "1"}))
    with pytest.raises(TraceError, match="truth message 0 is missing"):
        list(trace.messages())


def test_a_message_that_does_not_follow_its_schema_is_named(tmp_path: Path) -> None:
    trace = Trace(foreign_file(tmp_path / "a.mcap", "/truth/verdict", 0, {"schema_version": "1"}))
    with pytest.raises(TraceError, match=r"/truth/verdict, truth message 0, 0\.00 s: \.true: Input should be a valid"):
        list(trace.of(Verdict))


def test_a_recorded_message_is_decoded_on_demand() -> None:
    recorded = Recorded("/perf", tick=0, sequence=0, data=b'{"milliseconds":{},"step":0}')
    assert recorded.message == Perf(step=0, milliseconds={})

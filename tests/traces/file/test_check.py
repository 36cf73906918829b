"""What `check` notices: every change to a recorded run is named with its place; a sound one is left in peace."""

import json
import re
import subprocess
import sys
import tracemalloc
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.JointStates_pb2 import JointStates
from kit.recordings import recorded
from kit.tampering import each, messages, records_of, renumbered, rewrite
from mcap.records import Attachment, Channel, Message, Metadata, Schema
from mcap.writer import Writer

from skolem.tools import cli
from skolem.traces.errors import TraceError
from skolem.traces.file.check import Flaw, check
from skolem.traces.file.codec import CONTENT, HashChain, decode
from skolem.traces.file.reader import Trace
from skolem.traces.file.recover import recover
from skolem.traces.file.writer import TraceWriter
from skolem.traces.messages import CLASS_OF, JSON_TOPICS, TRUTH, ActionResult, RunStart, TrueState, canonical


@pytest.fixture
def trace(tmp_path: Path, record_run: Callable[..., str]) -> Path:
    path = tmp_path / "sample.mcap"
    record_run(path, profile=True)
    return path


@pytest.fixture
def changed(trace: Path, tmp_path: Path) -> Callable[..., Flaw]:
    """Return the first fault of the sample run after an edit."""

    def after(edit: Callable[[list[object]], list[object]]) -> Flaw:
        flaw = check(rewrite(trace, tmp_path / "changed.mcap", edit)).flaw
        assert flaw is not None
        return flaw

    return after


def test_a_recorded_run_is_sound_and_its_hashes_are_those_of_the_reader(trace: Path) -> None:
    found = check(trace)
    assert (found.flaw, found.messages, found.steps) == (None, 20, 3)
    assert (found.content_hash, found.decision_hash) == (Trace(trace).content_hash, Trace(trace).decision_hash)


def test_writing_the_same_records_again_changes_nothing(trace: Path, tmp_path: Path) -> None:
    again = rewrite(trace, tmp_path / "again.mcap", lambda records: records)
    assert check(again).content_hash == check(trace).content_hash
    assert check(again).sound


# ---------------------------------------------------------------- the file


def test_any_flipped_byte_is_named_with_its_place(trace: Path) -> None:
    sound = trace.read_bytes()
    for place in range(0, len(sound), 1009):
        damaged = bytearray(sound)
        damaged[place] ^= 1 << place % 8
        trace.write_bytes(damaged)
        flaw = check(trace).flaw
        assert flaw is not None, place
        assert flaw.byte is not None, place
        assert flaw.remedy, place


def test_a_flipped_byte_in_a_chunk_is_found_in_that_chunk(trace: Path) -> None:
    sound = bytearray(trace.read_bytes())
    inside = sound.index(b"zstd", sound.index(b"zstd") + 1) + 60
    sound[inside] ^= 1
    trace.write_bytes(sound)
    flaw = check(trace).flaw
    assert flaw is not None
    assert flaw.byte is not None
    assert flaw.message == "the chunk does not match its checksum: its bytes were changed"
    assert inside - 200 < flaw.byte < inside


def test_a_file_cut_at_any_of_twenty_places_is_named_so(trace: Path) -> None:
    sound = trace.read_bytes()
    for size in range(9, len(sound), len(sound) // 20):
        trace.write_bytes(sound[:size])
        flaw = check(trace).flaw
        assert flaw is not None
        assert re.search("the file (ends|does not end)", flaw.message), flaw
        assert f"`skolem recover {trace} -o GOOD.mcap`" in flaw.remedy


def test_bytes_after_the_end_are_noticed(trace: Path) -> None:
    trace.write_bytes(trace.read_bytes() + b"x")
    assert "does not end as an MCAP file" in str(check(trace).flaw)


@pytest.mark.parametrize("content", [b"", b"skolem: 1\n"])
def test_what_is_no_trace_is_named_so(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "scenario.mcap"
    path.write_bytes(content)
    assert "not a trace: it does not begin as an MCAP file" in str(check(path).flaw)


def test_a_missing_file_is_named_so(tmp_path: Path) -> None:
    assert "cannot read the trace: No such file" in str(check(tmp_path / "nowhere.mcap").flaw)


# ---------------------------------------------------------------- the messages


def test_a_dropped_message_is_named_with_number_topic_and_step(changed: Callable[..., Flaw]) -> None:
    flaw = changed(messages(lambda found: found[:8] + found[9:]))
    assert (flaw.number, flaw.topic, flaw.step) == (9, "/obs", 1)
    assert flaw.message == "is decision message 7, expected 6: dropped, repeated or moved"


def test_every_single_dropped_message_is_noticed(trace: Path, changed: Callable[..., Flaw]) -> None:
    topics = topics_of(trace)
    last_truth, last_wall_time = (len(topics) - 1 - topics[::-1].index(topic) for topic in ("/tf", "/perf"))
    for number in range(len(topics)):

        def without(found: list[Message], number: int = number) -> list[Message]:
            return found[:number] + found[number + 1 :]

        if number == len(topics) - 1:
            assert "/run/end is missing" in changed(messages(without)).message
        elif number == last_truth:
            assert changed(messages(without)).step == 2
        elif number != last_wall_time:  # wall times are in no hash
            assert changed(messages(without)).number is not None


def topics_of(trace: Path) -> list[str]:
    return [recorded.topic for recorded in Trace(trace).messages()]


def test_a_dropped_message_whose_gap_is_hidden_breaks_the_chain(changed: Callable[..., Flaw]) -> None:
    def hidden(records: list[object]) -> list[object]:
        decisions = {r.id for r in records if isinstance(r, Channel) and r.topic not in ("/tf", "/perf")}
        kept = messages(lambda found: [m for m in found if m.channel_id in decisions])(records)
        return messages(lambda found: renumbered(found[:5] + found[6:]))(kept)

    flaw = changed(hidden)
    assert flaw.topic == "/chain"
    assert "the chain does not fit" in flaw.message


def test_two_swapped_messages_are_noticed(changed: Callable[..., Flaw]) -> None:
    flaw = changed(messages(lambda found: [*found[:1], found[2], found[1], *found[3:]]))
    assert (flaw.number, flaw.topic) == (1, "/action/result")
    assert flaw.message == "is decision message 2, expected 1: dropped, repeated or moved"


def test_a_repeated_message_is_noticed(changed: Callable[..., Flaw]) -> None:
    assert changed(messages(lambda found: [*found[:2], *found[1:]])).number == 2


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda data: data.replace(b'"status":"done"', b'"status":"fine"'), ".status: Input should be 'done'"),
        (lambda data: data.replace(b'"step":1', b'"step": 1'), "is not written canonically, from byte"),
        (lambda data: data.replace(b'"status":"done",', b""), ".status: Field required"),
        (lambda data: data.replace(b'"status"', b'"more":1,"status"'), ".more: Extra inputs are not permitted"),
        (lambda data: data.replace(b"0.1", b"NaN", 1), ".robot.left_arm[0]: Input should be a finite number"),
        (lambda data: data[:-1], "Invalid JSON"),
        (lambda data: b"\xff" + data, "Invalid JSON"),
    ],
)
def test_a_message_that_breaks_its_schema_is_named_with_the_field(
    change: Callable[[bytes], bytes], said: str, changed: Callable[..., Flaw]
) -> None:
    def bent(found: list[Message]) -> list[Message]:
        place = next(i for i, m in enumerate(found) if b'"status":"done"' in m.data and b'"step":1' in m.data)
        return [*found[:place], replace(found[place], data=change(found[place].data)), *found[place + 1 :]]

    flaw = changed(messages(bent))
    assert (flaw.topic, flaw.step) == ("/action/result", 1)
    assert said in flaw.message


def test_a_changed_value_that_keeps_to_the_schema_breaks_the_chain(changed: Callable[..., Flaw]) -> None:
    def bent(found: list[Message]) -> list[Message]:
        return [replace(m, data=m.data.replace(b'"points":150', b'"points":151')) for m in found]

    flaw = changed(messages(bent))
    assert (flaw.topic, flaw.step) == ("/chain", 0)


def test_a_damaged_protobuf_message_is_named(trace: Path, changed: Callable[..., Flaw]) -> None:
    tf = next(r.id for r in records_of(trace) if isinstance(r, Channel) and r.topic == "/tf")
    flaw = changed(each(Message, lambda m: replace(m, data=b"\xff") if m.channel_id == tf else m))
    assert (flaw.topic, flaw.step) == ("/tf", 0)
    assert "does not follow its schema" in flaw.message


# ---------------------------------------------------------------- what no counter and no chain covers


def physical_run() -> Path:
    """Return the trace of two actions of a robot with joints: every topic but pictures and wall times."""
    return recorded("sim1_green", world="pybullet", overrides=("limits.steps=2",))


def with_another_digit(topic: str, records: list[object]) -> list[object]:
    """Return a trace in which the first message of a topic says something else."""
    channel = next(r.id for r in records if isinstance(r, Channel) and r.topic == topic)
    place = next(i for i, r in enumerate(records) if isinstance(r, Message) and r.channel_id == channel)
    message = records[place]
    assert isinstance(message, Message)
    return [*records[:place], replace(message, data=other_digit(topic, message.data)), *records[place + 1 :]]


def other_digit(topic: str, data: bytes) -> bytes:
    if topic in JSON_TOPICS:
        digit = rb"(?<=[0-9]\.)[0-9]" if topic == "/run/end" else rb"[0-9](?=[^0-9]*$)"  # there the last are counts
        other = re.sub(digit, lambda found: b"7" if found[0] != b"7" else b"5", data, count=1)
        return other.replace(b"false", b"true") if topic == "/truth/verdict" else other
    message = decode(topic, data)
    assert isinstance(message, JointStates | FrameTransforms)
    if isinstance(message, JointStates):
        message.joints[0].position += 0.001
    else:
        message.transforms[0].translation.x += 0.001
    return bytes(message.SerializeToString(deterministic=True))


@pytest.mark.physics
def test_one_changed_digit_is_noticed_in_every_topic(tmp_path: Path) -> None:
    topics = set(topics_of(physical_run()))
    assert topics > {"/robot/joint_states", "/tf", "/truth/state", "/truth/verdict"}
    late = {  # what is written in the last step, and behind it; another digit may make a number that is written shorter
        "/truth/verdict": (2,),
        "/run/end": (2, None),
    }
    for topic in sorted(topics):
        path = rewrite(physical_run(), tmp_path / "changed.mcap", partial(with_another_digit, topic))
        flaw = check(path).flaw
        assert flaw is not None, topic
        assert flaw.step in late.get(topic, (0,)), (topic, flaw)
        if CLASS_OF[topic] == TRUTH:
            assert flaw.message.startswith("what was recorded since the step before is not as the hash"), flaw
        path.unlink()


@pytest.mark.physics
def test_two_messages_of_different_counters_that_are_swapped_are_noticed(tmp_path: Path) -> None:
    topics = topics_of(physical_run())
    for pair in (["/obs", "/truth/state"], ["/run/start", "/robot/joint_states"], ["/robot/joint_states", "/tf"]):
        at = next(i for i in range(len(topics)) if topics[i : i + 2] == pair)

        def swapped(found: list[Message], at: int = at) -> list[Message]:
            return [*found[:at], found[at + 1], found[at], *found[at + 2 :]]

        path = rewrite(physical_run(), tmp_path / "swapped.mcap", messages(swapped))
        flaw = check(path).flaw
        assert flaw is not None, pair
        if pair[0] == "/run/start":
            assert (flaw.number, flaw.topic, flaw.message) == (0, pair[1], "comes before /run/start")
        path.unlink()


def test_wall_times_are_in_no_hash(trace: Path, tmp_path: Path) -> None:
    path = rewrite(trace, tmp_path / "slower.mcap", partial(with_another_digit, "/perf"))
    assert check(path).sound


def test_a_hash_of_the_content_that_was_itself_changed_is_noticed(changed: Callable[..., Flaw]) -> None:
    def other(metadata: Metadata) -> Metadata:
        return replace(metadata, metadata={"sha256": "0" * 64}) if metadata.name == CONTENT else metadata

    assert changed(each(Metadata, other)).step == 0


def test_a_trace_from_before_there_was_a_hash_of_the_content_is_sound_and_said_to_have_none(
    trace: Path, tmp_path: Path
) -> None:
    path = rewrite(trace, tmp_path / "older.mcap", without_content_hash)
    found = check(path)
    assert found.sound
    assert found.remarks == (
        "remark: no hash of its content stands in the trace: that the truth is as it was written cannot be told",
    )


def without_content_hash(records: list[object]) -> list[object]:
    return [record for record in records if not (isinstance(record, Metadata) and record.name == CONTENT)]


@pytest.mark.parametrize(
    ("move", "said"),
    [
        (lambda m: replace(m, log_time=m.log_time + 1, publish_time=m.log_time + 1), "is not that of a tick"),
        (lambda m: replace(m, publish_time=m.log_time + 10**9), "is not that of a tick"),
        (lambda m: replace(m, log_time=10**10 - m.log_time, publish_time=10**10 - m.log_time), "is before"),
    ],
)
def test_time_that_is_no_tick_or_runs_backwards_is_noticed(
    move: Callable[[Message], Message], said: str, changed: Callable[..., Flaw]
) -> None:
    assert said in changed(each(Message, move)).message


def test_a_message_without_a_channel_is_noticed(changed: Callable[..., Flaw], trace: Path) -> None:
    flaw = check(trace).flaw
    assert flaw is None
    assert "there is no topic /weather" in changed(each(Channel, lambda c: replace(c, topic="/weather"))).message


def test_a_message_outside_of_the_chunks_is_noticed_and_can_be_recovered(trace: Path, tmp_path: Path) -> None:
    loose, kept = tmp_path / "loose.mcap", list(Trace(trace).messages())
    with loose.open("wb") as file:
        mcap = Writer(file, use_chunking=False, enable_data_crcs=True)
        mcap.start()
        for record in records_of(trace):
            match record:
                case Metadata():
                    mcap.add_metadata(record.name, record.metadata)
                case Schema():
                    mcap.register_schema(record.name, record.encoding, record.data)
                case Channel():
                    mcap.register_channel(record.topic, record.message_encoding, record.schema_id)
                case Message():
                    mcap.add_message(record.channel_id, record.log_time, record.data, 0, record.sequence)
                case _:
                    pass
        mcap.finish()
    assert "a message stands outside of the chunks" in str(check(loose).flaw)
    recover(loose, tmp_path / "good.mcap")
    assert list(Trace(tmp_path / "good.mcap").messages()) == kept


# ---------------------------------------------------------------- what the run says of itself


def test_a_run_without_its_end_is_named_so(changed: Callable[..., Flaw]) -> None:
    flaw = changed(messages(lambda found: found[:-1]))
    assert flaw.message == "/run/end is missing after 3 steps"
    assert "killed" in flaw.remedy
    assert flaw.position == ""


def test_a_trace_without_a_run_is_named_so(changed: Callable[..., Flaw]) -> None:
    assert changed(messages(lambda found: [])).message == "the trace holds no /run/start"


def test_a_run_that_does_not_begin_with_its_start_is_noticed(changed: Callable[..., Flaw]) -> None:
    def late(records: list[object]) -> list[object]:
        decisions = {r.id for r in records if isinstance(r, Channel) and r.topic not in ("/tf", "/perf")}
        kept = messages(lambda found: [m for m in found if m.channel_id in decisions])(records)
        return messages(lambda found: renumbered(found[1:]))(kept)

    assert changed(late).message == "comes before /run/start"


def test_a_schema_of_another_name_or_kind_is_refused(changed: Callable[..., Flaw]) -> None:
    flaw = changed(each(Schema, lambda s: replace(s, name="other.Plan") if s.name == "skolem.Plan" else s))
    assert "/plan has the schema jsonschema other.Plan, expected jsonschema skolem.Plan" in flaw.message
    flaw = changed(each(Schema, lambda s: replace(s, data=b"[]") if s.name == "skolem.Plan" else s))
    assert flaw.message == "the schema of /plan is no JSON Schema"
    flaw = changed(each(Channel, lambda c: replace(c, message_encoding="cbor") if c.topic == "/plan" else c))
    assert flaw.message == "messages of /plan are cbor, expected json"


def without_odometry(records: list[object]) -> list[object]:
    """Return a trace as it would have been recorded before the results of actions had odometry; its chain is broken."""

    def older(schema: Schema) -> Schema:
        if schema.name != "skolem.ActionResult":
            return schema
        known = json.loads(schema.data)
        del known["properties"]["odometry"]
        return replace(schema, data=canonical(known))

    def leaner(message: Message) -> Message:
        return replace(message, data=message.data.replace(b'"odometry":null,', b""))

    return each(Schema, older)(each(Message, leaner)(records))


def rechained(records: list[object]) -> list[object]:
    """Return a trace with its hash chain computed anew, as its own time would have written it."""
    topics, chain = {r.id: r.topic for r in records if isinstance(r, Channel)}, HashChain()
    found: list[object] = []
    for record in records:
        if isinstance(record, Message) and topics[record.channel_id] == "/chain":
            link = canonical(json.loads(record.data) | {"chain": chain.close()})
            found.append(replace(record, data=link))
            continue
        if isinstance(record, Message):
            chain.add(topics[record.channel_id], record.data)
        found.append(record)
    return found


def test_a_trace_from_before_a_field_was_added_is_sound_with_a_remark(
    trace: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = rewrite(
        trace, tmp_path / "older.mcap", lambda records: rechained(without_odometry(without_content_hash(records)))
    )
    assert len(list(Trace(path).of(ActionResult))) == 3
    found = check(path)
    assert found.sound, found.flaw
    [remark, _] = found.remarks
    assert "other schemas for /action/result" in remark
    monkeypatch.setattr("sys.argv", ["skolem", "check", str(path)])
    assert cli.main() == 0
    assert f"    {remark}" in capsys.readouterr().out.splitlines()


def test_a_message_that_its_own_older_schema_does_not_explain_is_a_fault(changed: Callable[..., Flaw]) -> None:
    assert "the chain does not fit" in changed(without_odometry).message
    only_messages = each(Message, lambda m: replace(m, data=m.data.replace(b'"odometry":null,', b"")))
    assert "is not written canonically" in changed(lambda records: rechained(only_messages(records))).message


def test_a_remark_is_not_made_of_a_trace_of_this_version(trace: Path) -> None:
    assert check(trace).remarks == ()


def test_a_message_that_breaks_its_schema_is_one_line_with_place_and_remedy_for_who_reads_it(
    trace: Path, tmp_path: Path
) -> None:
    def spoiled(message: Message) -> Message:
        return replace(message, data=message.data.replace(b'"status":"done"', b'"status":"fine"'))

    path = rewrite(trace, tmp_path / "bent.mcap", each(Message, spoiled))
    with pytest.raises(TraceError) as raised:
        list(Trace(path).of(ActionResult))
    assert str(raised.value) == (
        f"{path}: /action/result, decision message 2, 0.00 s: .status: Input should be 'done', 'failed' or "
        "'stopped_early'; `skolem check` says whether the trace was changed; if not, use the version that recorded it"
    )


def test_another_schema_version_is_refused(changed: Callable[..., Flaw]) -> None:
    def newer(metadata: Metadata) -> Metadata:
        return replace(metadata, metadata=metadata.metadata | {"schema_version": "99"})

    assert "has schema version 99, known is" in changed(each(Metadata, newer)).message
    assert "names no schema version" in changed(each(Metadata, lambda m: replace(m, metadata={}))).message


def test_metadata_that_contradict_the_run_are_noticed(changed: Callable[..., Flaw]) -> None:
    flaw = changed(each(Metadata, lambda m: replace(m, metadata=m.metadata | {"seed": "8"})))
    assert flaw.message == "the metadata say seed 8, the start of the run says 7"


@pytest.mark.parametrize("name", ["scenario.yaml", "rules/look.lp"])
def test_an_attachment_that_is_not_what_the_run_was_made_of_is_named(name: str, changed: Callable[..., Flaw]) -> None:
    flaw = changed(each(Attachment, lambda a: replace(a, data=b"other") if a.name == name else a))
    assert flaw.message == f"{name} differs from the attached file"
    gone = changed(lambda records: [r for r in records if not (isinstance(r, Attachment) and r.name == name)])
    assert gone.message == f"{name} is named, but not attached"


def test_an_attachment_that_the_run_does_not_name_is_noticed(changed: Callable[..., Flaw]) -> None:
    extra = Attachment(create_time=0, log_time=0, name="rules/own.lp", media_type="text/plain", data=b"")
    assert (
        "rules/own.lp is attached, but not named" in changed(lambda records: [records[0], extra, *records[1:]]).message
    )


@pytest.mark.parametrize("kind", [Attachment, Metadata])
def test_nothing_that_the_run_was_made_of_may_be_said_twice(kind: type[object], changed: Callable[..., Flaw]) -> None:
    def again(records: list[object]) -> list[object]:
        return [*records, next(record for record in records if isinstance(record, kind))]

    assert "is there twice" in changed(again).message


@pytest.mark.parametrize("name", ["rules//x.lp", "rules/../x.lp", "rules/x.txt", "rules/.lp", "notes.txt", "rules/"])
def test_a_name_that_no_rule_file_has_is_noticed_though_the_start_of_the_run_says_it(
    name: str, changed: Callable[..., Flaw]
) -> None:
    extra = Attachment(create_time=0, log_time=0, name=name, media_type="text/plain", data=b"")

    def named(records: list[object]) -> list[object]:
        start = next(r for r in records if isinstance(r, Message) and b'"rules_sha256"' in r.data)
        values = json.loads(start.data)
        values["rules_sha256"][name.removeprefix("rules/")] = "0" * 64
        told = replace(start, data=canonical(values))
        return [records[0], extra, *(told if record is start else record for record in records[1:])]

    assert f"{name!r} is not the name of a rule file" in changed(named).message


def test_an_end_that_counts_other_steps_is_noticed(changed: Callable[..., Flaw]) -> None:
    def more(found: list[Message]) -> list[Message]:
        end = replace(found[-1], data=re.sub(rb'"steps":\d+', b'"steps":99', found[-1].data))
        return [*found[:-1], end]

    assert "says that there were 99 steps, and there are" in changed(messages(more)).message


@pytest.mark.parametrize(
    "schema",
    [b'{"$ref":"#/$defs/A","$defs":{"A":{"$ref":"#/$defs/A"}}}', b'{"$ref":"#/$defs/B"}'],
)
def test_a_schema_by_which_nothing_can_have_been_written_is_named(schema: bytes, changed: Callable[..., Flaw]) -> None:
    flaw = changed(each(Schema, lambda s: replace(s, data=schema) if s.encoding == "jsonschema" else s))
    assert "the schema of /run/start is none that a trace can have: " in flaw.message


# ---------------------------------------------------------------- cost


def test_checking_takes_the_memory_of_a_chunk_not_of_the_file(trace: Path, tmp_path: Path) -> None:
    path, short = tmp_path / "long.mcap", Trace(trace)
    state = TrueState(step=0, world_T_base=(0.0, 0.0, 0.0), objects=(), sha256="x" * 4000)
    with TraceWriter(path, attachments=short.attachments, run={}, env={}) as writer:
        writer.write("/run/start", next(short.of(RunStart)), 0)
        for tick in range(2000):
            writer.write("/truth/state", state, tick)
    tracemalloc.start()
    found = check(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert (found.flaw, found.messages) == (None, 2002)
    assert peak < 2_000_000


def test_check_imports_neither_estimator_nor_simulator_nor_viewer() -> None:
    code = (
        "import sys; import skolem.tools.files.check, skolem.tools.show.info, skolem.tools.files.recover;"
        "print([m for m in ('gtsam', 'pybullet', 'rerun', 'clingo', 'numpy', 'scipy') if m in sys.modules])"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"

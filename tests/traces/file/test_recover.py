"""What `recover` saves: every message that is whole, as it was, whatever became of the rest of the file."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest
from kit.places import ROOT
from kit.recordings import recorded
from mcap.records import Chunk

from skolem.tools import cli
from skolem.traces.errors import InputError, TraceError
from skolem.traces.file.check import check
from skolem.traces.file.container import pieces
from skolem.traces.file.reader import Trace
from skolem.traces.file.recover import recover
from skolem.traces.messages import ActionResult, Chain

GREEN = ROOT / "scenarios" / "sim1_green.yaml"
STOPPING = f"""
import sys, time
from pathlib import Path
from skolem.tools.loop import prepare, run
from skolem.tools.loop.session import Unwatched

class Stopping(Unwatched):
    def acted(self, action, result, observation):
        if action.step == 3:
            print("in step 3", flush=True)
            time.sleep(60)

run(prepare(Path({str(GREEN)!r}), world="symbolic"), Path(sys.argv[1]), Stopping())
"""


@pytest.fixture
def trace(tmp_path: Path, record_run: Callable[..., str]) -> Path:
    path = tmp_path / "sample.mcap"
    record_run(path, steps=8, profile=True)
    return path


def test_a_sound_trace_comes_back_byte_for_byte(trace: Path, tmp_path: Path) -> None:
    found = recover(trace, tmp_path / "good.mcap")
    assert (found.messages, found.steps, found.ended, found.lost) == (50, 8, True, [])
    assert (tmp_path / "good.mcap").read_bytes() == trace.read_bytes()


def test_of_a_file_cut_at_any_of_twenty_places_every_whole_chunk_is_saved(trace: Path, tmp_path: Path) -> None:
    sound, whole = trace.read_bytes(), list(Trace(trace).messages())
    with trace.open("rb") as file:
        ends = [piece.byte + len(piece.data) for piece in pieces(file) if isinstance(piece.record, Chunk)]
    counts = []
    for size in range(ends[0], ends[-1], (ends[-1] - ends[0]) // 20):
        trace.write_bytes(sound[:size])
        found = recover(trace, tmp_path / f"{size}.mcap")
        saved = Trace(found.path)
        assert list(saved.messages()) == whole[: found.messages]
        assert found.steps == len(list(saved.of(ActionResult))) == sum(end <= size for end in ends)
        assert found.lost[0].byte <= size
        assert "/run/end is missing" in str(check(found.path).flaw)
        counts.append(found.messages)
    assert all(earlier <= later for earlier, later in pairwise(counts))
    assert (len(counts), counts[0], counts[-1]) == (21, 7, 49)


def test_attachments_and_metadata_are_kept_as_they_were(trace: Path, tmp_path: Path) -> None:
    before = Trace(trace)
    attachments, metadata = before.attachments, before.metadata
    trace.write_bytes(trace.read_bytes()[: -len(trace.read_bytes()) // 2])
    recover(trace, tmp_path / "good.mcap")
    after = Trace(tmp_path / "good.mcap")
    assert (after.attachments, after.metadata) == (attachments, metadata)


def test_a_damaged_chunk_is_left_out_and_the_others_are_kept(trace: Path, tmp_path: Path) -> None:
    damaged = bytearray(trace.read_bytes())
    third = [i for i in range(len(damaged)) if damaged.startswith(b"zstd", i)][2]
    damaged[third + 50] ^= 1
    trace.write_bytes(damaged)
    found = recover(trace, tmp_path / "good.mcap")
    assert (found.messages, found.steps, found.ended) == (44, 7, True)
    assert [damage.message for damage in found.lost] == [
        "the chunk does not match its checksum: its bytes were changed"
    ]
    flaw = check(found.path).flaw
    assert flaw is not None
    assert "dropped, repeated or moved" in flaw.message


def test_a_damaged_length_is_passed_over_with_the_index(trace: Path, tmp_path: Path) -> None:
    damaged = bytearray(trace.read_bytes())
    third = [i for i in range(len(damaged)) if damaged.startswith(b"zstd", i)][2] - 8 - 8 - 8 - 4 - 4 - 8
    assert damaged[third - 1] == 6  # the record's kind is a chunk, and its length follows
    damaged[third + 7] = 0xFF
    trace.write_bytes(damaged)
    found = recover(trace, tmp_path / "good.mcap")
    assert (found.messages, found.ended) == (44, True)
    assert "the file ends in the middle of a chunk" in found.lost[0].message


def test_the_first_chunk_may_be_lost_if_the_index_knows_the_channels(trace: Path, tmp_path: Path) -> None:
    damaged = bytearray(trace.read_bytes())
    damaged[damaged.index(b"zstd") + 50] ^= 1
    trace.write_bytes(damaged)
    found = recover(trace, tmp_path / "good.mcap")
    assert (found.messages, found.ended) == (43, True)
    assert len(list(Trace(found.path).of(Chain))) == 7


def test_every_flipped_byte_leaves_something_to_save(trace: Path, tmp_path: Path) -> None:
    sound = trace.read_bytes()
    for place in range(9, len(sound), 1009):
        damaged = bytearray(sound)
        damaged[place] ^= 1 << place % 8
        trace.write_bytes(damaged)
        assert recover(trace, tmp_path / f"{place}.mcap").messages >= 42, place


def test_nothing_is_left_behind_if_nothing_can_be_saved(trace: Path, tmp_path: Path) -> None:
    trace.write_bytes(trace.read_bytes()[:300])
    with pytest.raises(TraceError, match="no message in it is whole"):
        recover(trace, tmp_path / "good.mcap")
    assert [path.name for path in tmp_path.iterdir()] == ["sample.mcap"]


def test_the_damaged_file_is_never_written_over(trace: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is the damaged file itself"):
        recover(trace, tmp_path / "." / trace.name)
    partial = trace.rename(trace.with_name("run.mcap.partial"))
    before = partial.read_bytes()
    recover(partial, tmp_path / "run.mcap")
    assert partial.read_bytes() == before


def test_a_file_that_is_there_already_is_never_replaced(
    trace: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    bad, before = tmp_path / "bad.mcap", trace.read_bytes()
    bad.write_bytes(before[: len(before) // 2])
    monkeypatch.setattr(sys, "argv", ["skolem", "recover", str(bad), "-o", str(trace)])
    assert cli.main() == 2
    assert f"{trace}: exists and is not replaced; give another name" in capsys.readouterr().err
    assert trace.read_bytes() == before
    assert check(trace).sound


def test_what_an_earlier_copy_has_left_is_never_written_over(trace: Path, tmp_path: Path) -> None:
    left = trace.rename(tmp_path / "good.mcap.copying")
    before = left.read_bytes()
    with pytest.raises(InputError, match=r"good\.mcap\.copying: exists"):
        recover(left, tmp_path / "good.mcap")
    assert left.read_bytes() == before
    assert recover(left, tmp_path / "other.mcap").messages == 50


def test_of_a_trace_with_a_gap_is_shown_what_there_is_and_nothing_is_thought_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    sound = recorded("sim1_green").read_bytes()
    chunks = [i for i in range(len(sound)) if sound.startswith(b"zstd", i)]
    for number, shown in ((0, "goal: unknown"), (3, "goal: exists o.")):
        damaged = bytearray(sound)
        damaged[chunks[number] + 50] ^= 1
        bad, good = tmp_path / f"{number}.bad", tmp_path / f"{number}.mcap"
        bad.write_bytes(damaged)
        recover(bad, good)
        for verb, status, said in (("show", 0, shown), ("replay", 3, ""), ("explain", 3, "")):
            monkeypatch.setattr(sys, "argv", ["skolem", verb, str(good)])
            assert (number, verb, cli.main()) == (number, verb, status)
            out, err = capsys.readouterr()
            assert said in out
            assert status == 0 or "is missing" in err or "nothing to replay" in err


def test_a_place_that_cannot_be_written_is_named(trace: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written: Not a directory"):
        recover(trace, tmp_path / "file" / "good.mcap")


def test_a_run_killed_in_the_middle_is_saved_to_its_last_step_and_can_be_shown(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """SIGKILL in step 3: steps 0 to 2 are on the disk."""
    out, good = tmp_path / "run.mcap", tmp_path / "good.mcap"
    command = [sys.executable, "-c", STOPPING, str(out)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=os.environ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "in step 3\n"
        process.kill()
    assert not out.exists()

    def called(*args: str) -> tuple[int, str]:
        monkeypatch.setattr(sys, "argv", ["skolem", *args])
        return cli.main(), capsys.readouterr().out

    status, said = called("recover", f"{out}.partial", "-o", str(good), "--json")
    saved = json.loads(said)
    assert (status, saved["steps"], saved["ended"]) == (0, 3, False)
    assert saved["messages"] == len(list(Trace(good).messages())) > 20
    assert saved["simulated_s"] > 0.0
    status, said = called("check", str(good), "--json")
    assert (status, json.loads(said)["fault"]["message"]) == (3, "/run/end is missing after 3 steps")
    status, said = called("info", str(good))
    assert (status, "the run has no end: killed or cut off" in said) == (0, True)
    status, said = called("show", str(good), "--step", "2")
    assert (status, "did: look at" in said) == (0, True)
    status, said = called("replay", str(good))
    assert (status, "IDENTICAL: 3 decisions" in said) == (0, True)

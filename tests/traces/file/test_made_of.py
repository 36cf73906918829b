"""What a run was made of is what its trace holds, and nothing that a trace names is written or read elsewhere."""

from pathlib import Path

import pytest
from kit.recordings import recorded
from kit.tampering import rewrite
from mcap.records import Attachment

from skolem.tools.recorded.rules import Rulebooks
from skolem.tools.recorded.run import RecordedRun
from skolem.traces.errors import TraceError
from skolem.traces.file.reader import Trace


def without(name: str, path: Path) -> Path:
    """Return a recorded run as it is recovered when the bytes of one of its files are lost."""
    source = recorded("sim1_green", 0, "symbolic")
    return rewrite(
        source, path, lambda records: [r for r in records if not isinstance(r, Attachment) or r.name != name]
    )


@pytest.mark.parametrize("name", ["rules/mutex.lp", "rules/weigh.lp", "rules/infer.lp", "scenario.yaml"])
def test_a_run_of_which_a_file_is_lost_is_not_thought_again_with_the_others(name: str, tmp_path: Path) -> None:
    with pytest.raises(TraceError, match=f"what the run was made of is not in it any more: {name} is named, but not"):
        RecordedRun(without(name, tmp_path / "t.mcap"))


def test_a_run_of_which_a_file_is_changed_is_not_thought_again(tmp_path: Path) -> None:
    def changed(records: list[object]) -> list[object]:
        found = [r for r in records if isinstance(r, Attachment) and r.name == "rules/look.lp"]
        for each in found:
            each.data += b"% "
        return records

    with pytest.raises(TraceError, match=r"rules/look\.lp differs from the attached file"):
        RecordedRun(rewrite(recorded("sim1_green", 0, "symbolic"), tmp_path / "t.mcap", changed))


@pytest.mark.parametrize("way", ["rules/{}", "rules/../..{}", "rules/x/../../../..{}"])
def test_reading_rules_writes_nothing_where_their_names_point_to(way: str, tmp_path: Path) -> None:
    victim = tmp_path / "victim.lp"
    victim.write_text("precious", encoding="utf-8")
    attachments = Trace(recorded("sim1_green", 0, "symbolic")).attachments
    rulebook = Rulebooks().of(attachments | {way.format(victim): b"% written by a trace"})
    assert "% written by a trace" in {content.decode() for content in rulebook.files.values()}
    assert victim.read_text(encoding="utf-8") == "precious"

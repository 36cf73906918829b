"""Which floats must be equal: to the last digit on the machine that recorded them, within bounds on any other."""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest
from kit.recordings import recorded, rewritten, unchanged
from kit.tampering import each, rewrite
from mcap.records import Metadata

from skolem.tools import cli
from skolem.tools.recorded.fingerprint import DECIDES_FLOATS, differences
from skolem.traces.file.environment import environment
from skolem.traces.file.reader import Recorded, Trace
from skolem.traces.messages import Belief, Message


def test_this_machine_does_not_differ_from_itself() -> None:
    assert differences(environment()) == []
    assert differences(Trace(recorded("sim1_green")).metadata["env"]) == []


@pytest.mark.parametrize("key", DECIDES_FLOATS)
def test_whatever_may_change_a_last_digit_makes_another_machine(key: str) -> None:
    assert differences(environment() | {key: "another"}) == [key]


def test_what_changes_no_digit_makes_none() -> None:
    assert differences(environment() | {"source": "another", "version mcap": "0.0.1"}) == []


def test_a_last_digit_diverges_on_the_same_machine_and_is_within_bounds_on_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    nudged = rewritten(recorded("sim1_green"), tmp_path / "nudged.mcap", a_last_digit)
    elsewhere = rewrite(nudged, tmp_path / "elsewhere.mcap", each(Metadata, on_another_machine))
    replay = Replay(monkeypatch, capsys)
    status, found = replay(nudged)
    assert (status, found["status"], found["machine_differs_in"]) == (1, "diverged", [])
    assert found["fields"]["/belief.world_T_base[]"] == 1  # type: ignore[index]
    status, found = replay(elsewhere)
    assert (status, found["status"], found["machine_differs_in"]) == (0, "identical", ["simd"])
    assert found["tolerated_floats"] == 1


class Replay:
    """The verb, called in this process."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
        self._monkeypatch, self._capsys = monkeypatch, capsys

    def __call__(self, path: Path) -> tuple[int, Mapping[str, object]]:
        """Return the exit status and what is printed with --json."""
        self._monkeypatch.setattr("sys.argv", ["skolem", "replay", "--json", "--all", str(path)])
        status = cli.main()
        found: Mapping[str, object] = json.loads(self._capsys.readouterr().out)
        return status, found


def a_last_digit(message: Recorded) -> Iterator[Message]:
    """Change one float of the first belief by 1e-12."""
    found = unchanged(message)
    if isinstance(found, Belief) and found.step == 0:
        x, y, theta = found.world_T_base
        found = found.model_copy(update={"world_T_base": (x + 1e-12, y, theta)})
    yield found


def on_another_machine(metadata: Metadata) -> Metadata:
    """Change the processor of the environment that is recorded."""
    if metadata.name != "env":
        return metadata
    return Metadata(name=metadata.name, metadata=metadata.metadata | {"simd": "altivec"})

"""Only regular files are opened, by every verb for every path, and at once."""

import os
import socket
from collections.abc import Callable
from pathlib import Path

import pytest
from kit.places import SCENARIOS

from skolem.tools import cli
from skolem.traces.given import read_regular


def folder(path: Path) -> None:
    path.mkdir()


def bound(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(path.name if path.parent == Path() else str(path))


def device(path: Path) -> None:
    path.symlink_to("/dev/zero")


SPECIAL: list[Callable[[Path], None]] = [folder, os.mkfifo, bound, device]
VERBS = (
    ["check", "{}.mcap"],
    ["info", "{}.mcap"],
    ["show", "{}.mcap"],
    ["replay", "{}.mcap"],
    ["explain", "{}.mcap"],
    ["reproduce", "{}.mcap"],
    ["recover", "{}.mcap", "-o", "good.mcap"],
    ["diff", "{}.mcap", "{}.mcap"],
    ["run", "{}.yaml", "--world", "symbolic"],
    ["scenario", "check", "{}.yaml"],
    ["sweep", "{}.yaml", "--seeds", "0", "-o", "out"],
)


@pytest.mark.parametrize("make", SPECIAL)
def test_a_special_file_is_refused(
    tmp_path: Path, make: Callable[[Path], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    make(Path("a"))
    with pytest.raises(OSError, match=r"not a regular file|Is a directory"):
        read_regular(Path("a"), 10)


def test_a_file_is_read_up_to_its_limit_and_one_byte(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"x" * 100)
    assert read_regular(tmp_path / "a", 10) == b"x" * 11


@pytest.mark.parametrize("verb", VERBS, ids=lambda verb: " ".join(verb[:2]))
def test_every_verb_refuses_special_files_with_one_message(
    tmp_path: Path, verb: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for make in SPECIAL:
        name = make.__name__
        for suffix in ("mcap", "yaml"):
            make(Path(f"{name}.{suffix}"))
        monkeypatch.setattr("sys.argv", ["skolem", *(word.format(name) for word in verb)])
        assert cli.main() in (2, 3)
        captured = capsys.readouterr()
        assert "Traceback" not in captured.out + captured.err
        assert name in captured.out + captured.err


@pytest.mark.parametrize("make", SPECIAL)
def test_a_rule_file_is_regular_too(
    tmp_path: Path,
    make: Callable[[Path], None],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    make(Path("own.lp"))
    text = (SCENARIOS / "sim1_green.yaml").read_text(encoding="utf-8")
    Path("a.yaml").write_text(text.replace("\nseed:", "\nrules: [own.lp]\nseed:", 1), encoding="utf-8")
    for verb in (
        ["rules", "check", "own.lp"],
        ["scenario", "check", "a.yaml"],
        ["run", "a.yaml", "--world", "symbolic"],
    ):
        monkeypatch.setattr("sys.argv", ["skolem", *verb])
        assert cli.main() == 2
        captured = capsys.readouterr()
        assert "own.lp" in captured.out + captured.err

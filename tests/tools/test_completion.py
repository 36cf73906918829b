"""Completion by the shell: of verbs without loading them, of their options, and of the worlds that are installed."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from skolem.tools.cli import VERBS

HEAVY = {"numpy", "scipy", "gtsam", "pybullet", "rerun", "clingo", "mcap", "ompl", "ruamel"}  # typer loads pydantic
WATCHED = (
    "import json, sys\nsys.argv = ['skolem']\nfrom skolem.tools.cli import main\nmain()\n"
    "print(json.dumps(sorted(sys.modules)), file=sys.stderr)"
)


def completing(line: str) -> tuple[list[str], set[str]]:
    """Return what bash is offered at the end of a line, and which modules were loaded for it."""
    words = {"COMP_WORDS": line, "COMP_CWORD": str(len(line.split(" ")) - 1), "_SKOLEM_COMPLETE": "complete_bash"}
    done = subprocess.run(
        [sys.executable, "-c", WATCHED], capture_output=True, text=True, env=os.environ | words, check=True
    )
    return done.stdout.split(), set(json.loads(done.stderr))


def test_verbs_are_completed_without_loading_any() -> None:
    offered, loaded = completing("skolem re")
    assert offered == ["recover", "replay", "reproduce"]
    assert not loaded & HEAVY
    rooms = {".".join(name.split(".")[:3]) for name in loaded if name.startswith("skolem.tools.")}
    assert rooms == {"skolem.tools.cli", "skolem.tools.words"}  # `words` is no verb: it prints what comes from files


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("skolem --vers", ["--version"]),
        ("skolem run a.yaml --opt", ["--optimal"]),
        ("skolem run a.yaml --world sy", ["symbolic"]),
        ("skolem sweep a.yaml --world ", ["pybullet", "symbolic"]),
        ("skolem rules d", ["doc"]),
        ("skolem nothing ", list(VERBS)),
    ],
)
def test_options_values_and_inner_verbs_are_completed(line: str, offered: list[str]) -> None:
    assert completing(line)[0] == offered


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not installed")
def test_completion_is_installed_for_the_shell_in_use(tmp_path: Path) -> None:
    command = f"{sys.executable} -m skolem --install-completion; {sys.executable} -m skolem --show-completion; true"
    done = subprocess.run(
        ["bash", "-c", command], capture_output=True, text=True, cwd=tmp_path, env=os.environ | {"HOME": str(tmp_path)}
    )
    assert "bash completion installed in" in done.stdout, done.stderr
    [script] = [path for path in tmp_path.rglob("*skolem*") if path.is_file()]
    assert "_SKOLEM_COMPLETE=complete_bash" in script.read_text(encoding="utf-8")
    assert "_SKOLEM_COMPLETE=complete_bash" in done.stdout

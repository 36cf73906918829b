"""What README promises of its first command, and docs/replay.md of a folder of traces, is what happens."""

import json
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Final

import pytest
from kit.places import DATA, GOLDEN, ROOT, RULES
from typer.testing import CliRunner

from skolem.tools.recorded.fingerprint import DECIDES_FLOATS, differences
from skolem.tools.replay import command as replay
from skolem.traces.file.environment import environment

README: Final = (ROOT / "README.md").read_text(encoding="utf-8")
RECORDED: Final = "readme.json"  # the content hash in README, and the machine on which the run has it
CONTENT: Final = re.compile(r"\(content (\w+)\)")
WALL: Final = re.compile(r"[\d.]+ s wall")
PROCESSOR: Final = ("vendor_id", "cpu family", "model\t")  # by these OpenBLAS chooses its kernels


@pytest.fixture(scope="module")
def block() -> str:
    """Return the output that README shows of `make demo`."""
    found = re.search(r"^```\n\$ make demo\n(.*?)^```$", README, re.DOTALL | re.MULTILINE)
    assert found
    return found[1]


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Return what the command behind `make demo` prints; its trace lies elsewhere, under the same name."""
    asked = ["make", "--no-print-directory", "-n", "demo"]  # make would name its folder if tests run under it
    recipe = subprocess.run(asked, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    _, *arguments = shlex.split(recipe.splitlines()[-1])
    trace = arguments[arguments.index("-o") + 1]
    elsewhere = str(tmp_path_factory.mktemp("demo") / Path(trace).name)
    command = [str(Path(sys.executable).with_name("skolem")), *arguments]
    command[command.index(trace)] = elsewhere
    both = subprocess.STDOUT  # steps go to standard error, the verdict to standard output
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=both, text=True, check=False)
    assert done.returncode == 0, done.stdout
    return done.stdout.replace(elsewhere, trace)


@pytest.mark.physics
def test_the_first_command_prints_what_readme_shows_but_for_wall_time_and_hash(block: str, printed: str) -> None:
    assert stable(printed) == stable(block)


@pytest.mark.physics
def test_the_trace_has_the_hash_that_readme_shows_on_the_machine_that_stands_beside_it(
    printed: str, request: pytest.FixtureRequest
) -> None:
    """`pytest --update-golden` records this machine and its hash; README is then changed by hand."""
    here = {key: environment()[key] for key in DECIDES_FLOATS}
    found = json.dumps({"content": content(printed), "environment": here, "processor": processor()}, indent=2) + "\n"
    if request.config.getoption("--update-golden"):
        (DATA / RECORDED).write_text(found, encoding="utf-8")
    recorded = json.loads((DATA / RECORDED).read_text(encoding="utf-8"))
    other = differences(recorded["environment"])
    other += ["processor"] * (recorded["processor"] != processor())
    if other:
        pytest.skip(f"the hash in README is of a machine with another {', '.join(other)}")
    assert content(printed) == recorded["content"]


def test_readme_shows_the_hash_that_stands_beside_the_machine(block: str) -> None:
    assert content(block) == json.loads((DATA / RECORDED).read_text(encoding="utf-8"))["content"]


def test_a_what_if_over_a_folder_takes_two_lines_for_a_trace_that_stays_the_same_and_one_more_for_each_change() -> None:
    unchanged, changed = GOLDEN / "limit_reached.mcap", GOLDEN / "sim1_green.mcap"
    lines = what_if(unchanged, changed, "--rules", str(RULES))
    assert [line.startswith("  ") for line in lines] == [False, True, False, True, False]
    lines = what_if(changed, "--rules", str(RULES), "--set", "threshold=0.8")
    count = re.search(r"CHANGED: (\d+) of", lines[0])
    assert count
    assert len(lines) == 2 + int(count[1])


def what_if(*arguments: str | Path) -> list[str]:
    """Return the lines that `skolem replay` prints."""
    return CliRunner().invoke(replay.app, [*map(str, arguments)]).stdout.splitlines()


def stable(text: str) -> str:
    """Return a transcript without wall times and the hash."""
    return CONTENT.sub("(content ..)", WALL.sub(".. s wall", text))


def content(text: str) -> str:
    """Return the hash in a transcript."""
    found = CONTENT.search(text)
    assert found, text
    return found[1]


def processor() -> str:
    """Return maker, family and model of the first processor; empty where the system does not say."""
    info = Path("/proc/cpuinfo")
    first = info.read_text(encoding="utf-8").partition("\n\n")[0] if info.exists() else ""
    values = [line.partition(":")[2].strip() for line in first.splitlines() if line.startswith(PROCESSOR)]
    return " ".join(values)

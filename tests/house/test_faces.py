"""The faces of the packages: what each promises, that it is there, and that it is loaded when it is used.

Loading is seen by `sys.modules` in a process of its own, never by time.
"""

import json
import subprocess
import sys
from importlib import import_module

import pytest
from kit.places import ROOT

FOLDERS = ("rules", "reasoner", "estimation", "sim", "traces", "tools")
PACKAGES = sorted(
    f"skolem.{path.parent.relative_to(ROOT).as_posix().replace('/', '.')}"
    for folder in FOLDERS
    for path in (ROOT / folder).rglob("__init__.py")
)
HEAVY = ("clingo", "gtsam", "mcap", "numpy", "ompl", "pybullet", "pydantic", "rerun", "rich", "ruamel", "scipy")
PROMISED = {
    "skolem.traces": "Fault InputError InternalError SkolemError Trace TraceError TraceWriter check compare follow",
    "skolem.reasoner": "Agent BeliefQueries Geometry Goal Limits Normal PlainBelief Turn load_rules parse_goal",
    "skolem.estimation": "Belief EstimatorConfig",
    "skolem.sim": "PlanningWorld PyBulletWorld SymbolicGeometry SymbolicWorld load_scenario",
    "skolem.tools.loop": "Mind Outcome Watcher World WorldKind WorldStart prepare run verdict worlds",
}
# names that are a function of the face and a module or a room at once
SHADOWED = [("skolem.traces", "compare", "skolem.traces.compare.diff"), ("skolem.tools.loop", "verdict", "")]


def said(code: str) -> str:
    """Return what a program prints in a process of its own."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=True)
    return done.stdout.strip()


def loaded_by(code: str) -> set[str]:
    """Return the modules that a program loads."""
    listing = "import json, sys; print(json.dumps(sorted(sys.modules)))"
    return set(json.loads(said(f"{code}\n{listing}").splitlines()[-1]))


@pytest.mark.parametrize("name", PACKAGES)
def test_every_package_says_what_it_promises_sorted_and_keeps_it(name: str) -> None:
    package = import_module(name)
    promised = list(package.__all__)
    assert promised == sorted(set(promised))
    assert not [each for each in promised if getattr(package, each, None) is None]


@pytest.mark.parametrize("name", sorted(PROMISED))
def test_a_face_promises_what_its_users_were_told_and_nothing_else(name: str) -> None:
    assert " ".join(import_module(name).__all__) == PROMISED[name]


def test_rooms_without_a_face_promise_nothing() -> None:
    faces = {name for name in PACKAGES if import_module(name).__all__}
    assert faces == {*PROMISED, "skolem.traces.messages"}


def test_a_name_that_is_not_promised_is_no_attribute() -> None:
    with pytest.raises(AttributeError, match="Rulebook"):
        _ = import_module("skolem.reasoner").Rulebook


@pytest.mark.parametrize("name", PACKAGES)
def test_importing_a_package_loads_no_library(name: str) -> None:
    assert not loaded_by(f"import {name}") & set(HEAVY)


@pytest.mark.parametrize("verb", ["--help", "--version"])
def test_the_command_line_without_a_verb_loads_no_library(verb: str) -> None:
    call = f"import sys; sys.argv = ['skolem', '{verb}']; from skolem.tools.cli import main; main()"
    assert not loaded_by(call) & set(HEAVY)


@pytest.mark.parametrize("name", sorted(PROMISED["skolem.traces"].split()))
def test_traces_are_read_and_written_without_the_viewer(name: str) -> None:
    assert not loaded_by(f"from skolem.traces import {name}") & {"rerun", "pyarrow", "clingo", "gtsam", "pybullet"}


@pytest.mark.parametrize(("face", "name", "module"), SHADOWED)
def test_a_name_that_is_a_function_and_a_module_is_the_function_whatever_came_first(
    face: str, name: str, module: str
) -> None:
    before = f"import {module or f'{face}.{name}'}; "
    for order in ("", before):
        assert said(f"{order}from {face} import {name}; print(type({name}).__name__)") == "function"
    after = f"from {face} import {name}; {before}import {face}; print(type({face}.{name}).__name__)"
    assert said(after) == "function"

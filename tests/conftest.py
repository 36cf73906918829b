"""What every test shares: golden texts, reproducible hypothesis examples, the type checkers' view, a small trace."""

import difflib
import os
import runpy
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from kit.draws import USUAL
from kit.places import ROOT

TYPE_FARM = ROOT / ".types" / "skolem"
PACKAGE_FOLDERS = ("rules", "reasoner", "estimation", "sim", "traces", "tools")
PACKAGE_FILES = ("__init__.py", "__main__.py", "py.typed")

# Speed is measured elsewhere: a slow machine fails no property test, neither by a deadline nor by a health check.
settings.register_profile(
    "reproducible", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow], max_examples=USUAL
)
settings.register_profile(
    "fresh",
    settings.get_profile("reproducible"),
    derandomize=False,
    database=None,  # the seed alone decides what is drawn: `make laws` prints it
    max_examples=int(os.environ.get("EXAMPLES", "10")),
)
settings.load_profile("reproducible")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-golden", action="store_true", help="rewrite the golden texts under tests/data")


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Callable[[str, str], None]:
    """Compare a text with the golden file of that name, or rewrite the file if --update-golden is given."""

    def compare(name: str, text: str) -> None:
        path = ROOT / "tests" / "data" / name
        if request.config.getoption("--update-golden"):
            path.write_text(text, encoding="utf-8")
        before = path.read_text(encoding="utf-8") if path.exists() else ""
        diff = difflib.unified_diff(before.splitlines(), text.splitlines(), name, "now", lineterm="", n=2)
        if before != text:
            pytest.fail("\n".join(diff) + "\nif this is meant: pytest --update-golden, and say why in the commit")

    return compare


@pytest.fixture
def record_run() -> Callable[..., str]:
    """Return the function of `sample_run.py` that records a small run and returns its content hash."""
    record: Callable[..., str] = runpy.run_path(str(ROOT / "tests" / "kit" / "sample_run.py"))["record"]
    return record


@pytest.fixture(scope="session")
def green_trace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the trace of a whole run in the world without physics, in which plans are dropped."""
    from skolem.tools.loop.session import run
    from skolem.tools.loop.setup import prepare

    path = tmp_path_factory.mktemp("green") / "green.mcap"
    setup = prepare(ROOT / "scenarios" / "sim1_green.yaml", seed=3, world="symbolic")
    run(setup, path)
    return path


@pytest.fixture(scope="session")
def type_farm() -> Path:
    """Return the folder of links that lets type checkers see `skolem.*`, made if it is absent."""
    TYPE_FARM.mkdir(parents=True, exist_ok=True)
    for target in (*PACKAGE_FOLDERS, *(f"package/{name}" for name in PACKAGE_FILES)):
        link = TYPE_FARM / Path(target).name
        if not link.is_symlink():
            link.symlink_to(Path("..") / ".." / target)
    return TYPE_FARM

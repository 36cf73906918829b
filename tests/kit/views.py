"""Runs to view, the numbers of their drawn rows, and the requirements of drawing."""

import shutil
from collections import Counter
from pathlib import Path

import rerun as rr
from kit.needs import missing
from kit.places import SCENARIOS
from rerun.chunk import RrdReader

from skolem.tools.loop.session import run
from skolem.tools.loop.setup import prepare
from skolem.tools.view.viewing import pr2_model
from skolem.traces.file.reader import Trace
from skolem.traces.scene.eye import Eye
from skolem.traces.scene.recording import Scene

DRIVERS = (Path("/usr/share/vulkan/icd.d"), Path("/etc/vulkan/icd.d"))
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
PICTURES = SCENARIOS.parent / "out" / "ci"  # folder that continuous integration keeps


def filmed(path: Path, name: str, steps: int) -> Trace:
    """Record the first steps of a run with physics, pictures of the camera included."""
    setup = prepare(SCENARIOS / f"{name}.yaml", [f"limits.steps={steps}"], 0, "pybullet", images=True)
    run(setup, path)
    return Trace(path)


def eye_of(trace: Trace) -> Eye:
    """Return the eye of the first view of a run."""
    scene = Scene(rr.RecordingStream("test"), pr2_model())
    scene.survey(trace)
    assert scene.eye is not None, "the run has no belief"
    return scene.eye


def rows_of(recording: Path) -> dict[str, int]:
    """Return the number of rows of each entity in a rerun recording."""
    count: Counter[str] = Counter()
    for chunk in RrdReader(recording).stream().to_chunks():
        count[chunk.entity_path.lstrip("/")] += chunk.num_rows
    return dict(count)


def need_driver() -> None:
    """Skip the test on a machine that cannot draw."""
    if not any(True for folder in DRIVERS for _ in folder.glob("*.json")):
        missing("a Vulkan driver, such as the package mesa-vulkan-drivers")


def need_browser() -> str:
    """Return the browser's command; skip the test on a machine without a browser."""
    found = next(filter(None, map(shutil.which, BROWSERS)), None)
    return found or missing("a browser, such as the package chromium")

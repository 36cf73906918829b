"""Views of a run: as a rerun recording, in a window or browser, as a picture, or live."""

import os
import sys
import time
import webbrowser
from contextlib import suppress
from pathlib import Path

import rerun as rr

from skolem.sim.physics.recording import BASE_FRAME
from skolem.sim.robot import pr2
from skolem.sim.robot.assets import patched_urdf_path
from skolem.tools.loop.children import has_display
from skolem.tools.view import viewer
from skolem.tools.words.terminal import output
from skolem.traces import Trace, follow
from skolem.traces.errors import Fault, InputError
from skolem.traces.file.reader import MAGIC
from skolem.traces.given import read_regular
from skolem.traces.messages import TICKS_PER_SECOND, Action
from skolem.traces.scene.recording import APPLICATION, Scene, convert
from skolem.traces.scene.robot import RobotModel
from skolem.traces.written import refuse_unwritable

POLL_S = 0.1


def pr2_model() -> RobotModel:
    """Return the PR2's meshes and the names of its joints."""
    return RobotModel(patched_urdf_path(), BASE_FRAME, pr2.BASE, pr2.TORSO, pr2.HEAD, pr2.ARM)


def spare_traces(out: Path, trace: Path) -> None:
    """Refuse to write over a trace, `trace` itself or another one.

    Raises:
        InputError: If `out` is a trace, is no file, or cannot be read to find out, or written.
    """
    refuse_unwritable(out)
    try:
        same = os.path.exists(out) and out.samefile(trace)
        recorded = read_regular(out, len(MAGIC) - 1) == MAGIC
    except FileNotFoundError:
        return
    except OSError as error:
        raise InputError([Fault(str(out), 0, 0, f"cannot be written: {error.strerror}")]) from error
    if same:
        raise InputError([Fault(str(out), 0, 0, "is the trace itself; give another name")])
    if recorded:
        raise InputError([Fault(str(out), 0, 0, "is a trace, and would be lost; give another name")])


def record(run: Trace, recording: Path, raw: bool = False) -> None:
    """Write a finished run as a rerun recording; `raw` shows terms as they are recorded.

    Raises:
        InputError: If the file cannot be written.
    """
    convert(run, recording, pr2_model(), raw)


def window(recording: Path) -> None:
    """Show a recording in a window, until it is closed or Ctrl-C."""
    with viewer.viewer("window", recording) as shown, suppress(KeyboardInterrupt):
        shown.wait()


def serve(recording: Path) -> None:
    """Show a recording in a browser, until Ctrl-C."""
    with viewer.viewer("web", recording) as shown:
        address = shown.serving()
        output(f"{address}\nCtrl-C ends it", file=sys.stderr, flush=True)
        if not (has_display() and webbrowser.open(address)):
            output("no browser was found here; open the address in one on this machine", file=sys.stderr, flush=True)
        with suppress(KeyboardInterrupt):
            shown.wait()


def follow_run(partial: Path, raw: bool = False) -> None:
    """Show a run in a window while it is recorded; after the run the window stays until it is closed."""
    with viewer.viewer("window") as shown, suppress(KeyboardInterrupt):
        draw_growing(partial, shown, raw)
        shown.wait()


def draw_growing(growing: Path, shown: viewer.Viewer, raw: bool = False) -> None:
    """Send a growing trace to a viewer step by step, until the run ends or the viewer is closed."""
    stream = rr.RecordingStream(APPLICATION)
    wire = rr.binary_stream(stream)
    scene = Scene(stream, pr2_model(), raw)
    for recorded in follow(growing):
        if recorded is not None:
            scene.take(recorded)
            continue
        scene.flush()
        if not shown.send(wire.read() or b""):
            return
        time.sleep(POLL_S)
    scene.flush()
    shown.send(wire.read() or b"", last=True)


def moment_of(text: str, run: Trace) -> viewer.Moment:
    """Return the moment that `step=N` or `time=S` names.

    Raises:
        InputError: If the text is neither, or the moment is not within the run.
    """
    kind, _, number = text.partition("=")
    try:
        moment: viewer.Moment = ("step", int(number)) if kind == "step" else ("time", float(number))
    except ValueError:
        kind = ""
    if kind not in ("step", "time"):
        raise InputError([Fault("--at", 0, 0, f"step=N or time=S, with a number, is expected (got {text!r})")])
    steps = [action.step + 1 for action in run.of(Action)]
    limit = max(steps, default=0) if kind == "step" else max(r.tick for r in run.messages()) / TICKS_PER_SECOND
    if not 0 <= moment[1] <= limit:
        raise InputError([Fault("--at", 0, 0, f"the run has {kind} 0 to {limit:g} (got {moment[1]:g})")])
    return moment

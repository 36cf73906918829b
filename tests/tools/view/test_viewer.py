"""The rerun viewer as our child: what it draws, whom it talks to, and that it is gone when we are."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from threading import Timer
from typing import IO

import psutil
import pytest
from kit.chromium import page
from kit.places import SCENARIOS
from kit.recordings import recorded
from kit.views import PICTURES, need_browser, need_driver
from PIL import Image

from skolem.tools.view import viewer, viewing
from skolem.tools.view.viewer import LOOPBACK, complaints
from skolem.traces.errors import InputError
from skolem.traces.file.reader import Trace
from skolem.traces.file.writer import partial_of

pytestmark = pytest.mark.viewer
SKOLEM = [sys.executable, "-c", "from skolem.tools.cli import main; raise SystemExit(main())"]
MANY = 1000  # colours: an empty view, or a page that is still loading, has fewer
LONG_S = 90.0
SOME = 50  # colours: an empty plan stack has one
Area = tuple[float, float, float, float]  # left, top, right, bottom, as shares of the window
WORLD: Area = (0.0, 0.08, 0.54, 0.63)  # where the 3D view is
PLAN: Area = (0.56, 0.08, 0.99, 0.48)  # where the plan stack is


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("recording") / "sim3.rrd"
    viewing.record(Trace(recorded("sim3_unknown")), out)
    return out


def colours(picture: bytes, area: Area) -> int:
    """Return how many colours a part of a picture has."""
    with Image.open(BytesIO(picture)) as image:
        left, top, right, bottom = area
        w, h = image.size
        part = image.convert("RGB").crop((int(left * w), int(top * h), int(right * w), int(bottom * h)))
    return len(part.getcolors(w * h) or ())


def until(found: Callable[[], bool], seconds: float) -> bool:
    """Wait until something is found; return whether it was."""
    deadline = time.monotonic() + seconds
    while not (there := found()) and time.monotonic() < deadline:
        time.sleep(0.1)
    return there


def test_a_picture_shows_the_world_and_no_view_complains(recording: Path) -> None:
    need_driver()
    picture = PICTURES / "view-native.png"
    assert viewer.shoot(recording, picture, ("step", 2)) == []
    with Image.open(picture) as image:
        assert image.size == (1600, 1000)
    assert colours(picture.read_bytes(), WORLD) > MANY


def test_a_recording_without_things_is_found_out(tmp_path: Path) -> None:
    """The measure by which the picture above is not empty."""
    import rerun as rr

    from skolem.traces.scene.blueprint import blueprint

    need_driver()
    stream = rr.RecordingStream("skolem")
    stream.save(tmp_path / "empty.rrd")
    stream.log("log", rr.TextLog("nothing"), static=True)
    stream.send_blueprint(blueprint(pictures=False, eye=None))
    stream.flush()
    stream.disconnect()
    viewer.shoot(tmp_path / "empty.rrd", tmp_path / "empty.png", None)
    assert colours((tmp_path / "empty.png").read_bytes(), WORLD) < MANY


def test_the_browser_shows_the_world_too(recording: Path) -> None:
    browser = need_browser()
    with (
        viewer.viewer("web", recording) as shown,
        page(browser, shown.serving(), 1600, 1000) as opened,
    ):
        pictures: list[bytes] = []

        def drawn() -> bool:
            pictures.append(opened.picture())
            return colours(pictures[-1], WORLD) > MANY and colours(pictures[-1], PLAN) > SOME

        there = until(drawn, 240.0)  # 20 s on an idle machine
    PICTURES.mkdir(parents=True, exist_ok=True)
    (PICTURES / "view-web.png").write_bytes(pictures[-1])
    assert there


def test_a_run_is_drawn_while_it_is_recorded(tmp_path: Path) -> None:
    """The recorded bytes are those of a run that nobody looks at."""
    need_driver()
    path, alone = tmp_path / "run.mcap", recorded("sim1_green", overrides=("limits.steps=2",))
    short = ["--set", "limits.steps=2", "--seed", "0", "--world", "symbolic"]
    run = subprocess.Popen([*SKOLEM, "run", str(SCENARIOS / "sim1_green.yaml"), *short, "-q", "-o", str(path)])
    while (growing := begun(path)) is None:
        assert run.poll() is None
    with growing, viewer.viewer("headless") as shown:
        alarm = Timer(LONG_S, os.kill, (shown.pid, signal.SIGTERM))  # nothing grows if the run fails at its start
        alarm.start()
        viewing.draw_growing(Path(f"/dev/fd/{growing.fileno()}"), shown)
        alarm.cancel()
        client = shown.loaded()
        assert until(lambda: len(client.get_state().views) > 0 and not complaints(client), 20.0), complaints(client)
    assert run.wait(30) == 1  # the limit was reached
    assert path.read_bytes() == alone.read_bytes()


def begun(trace: Path) -> IO[bytes] | None:
    """Return a trace that is being written, held open whatever name it gets; None if it is not there yet."""
    for path in (partial_of(trace), trace):
        with suppress(FileNotFoundError):
            return path.open("rb")
    return None


def test_it_keeps_its_files_apart_and_is_told_to_send_no_statistics(tmp_path: Path) -> None:
    environment = viewer.private_environment(tmp_path)
    assert environment["XDG_CONFIG_HOME"] == environment["XDG_DATA_HOME"] == str(tmp_path)
    said = json.loads((tmp_path / "rerun" / "analytics.json").read_text())
    assert said == {"analytics_enabled": False}


def test_it_listens_to_this_machine_alone_and_ends_with_the_block(recording: Path) -> None:
    with viewer.viewer("web", recording) as shown:
        shown.serving()
        process = psutil.Process(shown.pid)
        listening = [c for c in process.net_connections() if c.status == psutil.CONN_LISTEN]
        elsewhere = [c for c in process.net_connections() if c.raddr and c.raddr.ip != LOOPBACK]
    assert {c.laddr.ip for c in listening} == {LOOPBACK}
    assert not elsewhere
    assert not process.is_running()


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_it_ends_when_its_parent_is_ended(recording: Path, how: signal.Signals) -> None:
    code = (  # Ctrl-C is heard in a background job too
        "import signal, sys; from pathlib import Path; from skolem.tools.view.viewer import viewer\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "with viewer('web', Path(sys.argv[1])) as shown:\n"
        "    print(shown.pid, flush=True); shown.wait()"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code, str(recording)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as parent:
        assert parent.stdout is not None
        child = psutil.Process(int(parent.stdout.readline()))
        parent.send_signal(how)
        try:
            parent.wait(20)
        finally:
            parent.kill()
    assert until(lambda: not child.is_running() or child.status() == psutil.STATUS_ZOMBIE, 10.0)


def test_without_a_driver_the_message_says_what_to_install(recording: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("VK_DRIVER_FILES", "VK_ICD_FILENAMES", "__EGL_VENDOR_LIBRARY_FILENAMES"):
        monkeypatch.setenv(name, "/nonexistent")
    with pytest.raises(InputError, match="mesa-vulkan-drivers"), viewer.viewer("headless", recording) as shown:
        shown.loaded()


def test_without_a_display_a_window_is_refused(recording: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(InputError, match="--shot"), viewer.viewer("window", recording):
        pass

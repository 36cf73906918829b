"""The rerun viewer as a child process that uses no network beyond this machine and ends with its parent.

The binary is started directly: the `rerun` command is a Python wrapper whose end leaves the viewer behind. The viewer
listens on 127.0.0.1, not on all addresses as by default; its own configuration folder switches usage statistics off.
"""

import json
import os
import shutil
import socket
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from typing import Final, Literal, TypeVar

from PIL import Image
from rerun.experimental import ViewerClient

from skolem.tools.loop.children import NO_DISPLAY, end, end_with_parent, has_display
from skolem.traces.errors import Fault, InputError, InternalError
from skolem.traces.scene.rows import SIM_TIME, STEP
from skolem.traces.written import put, refuse_unwritable

LOOPBACK: Final = "127.0.0.1"
READY_S, POLL_S = 60.0, 0.05
DRAW_S, STILL_S, SETTLE_S = 1.0, 0.3, 15.0  # first wait, wait between two pictures, longest wait for a stable picture
WINDOW: Final = "1600x1000"
NO_DRIVER: Final = (
    "the viewer finds no Vulkan driver; install one (software, on Debian and Ubuntu: apt install mesa-vulkan-drivers)"
)
_DRIVER_WORDS = ("No graphics adapter", "Failed to get render context")  # in messages of the viewer
_DISPLAY_WORDS = ("DISPLAY is set", "connection to X server")
Moment = tuple[Literal["step"], int] | tuple[Literal["time"], float]

Found = TypeVar("Found")


class Viewer:
    """A running viewer.

    Attributes:
        port: Its port for data and questions.
        web_port: The port of its web page; 0 if it serves none.
    """

    def __init__(self, process: "subprocess.Popen[bytes]", said: Path, port: int, web_port: int) -> None:
        self._process, self._said = process, said
        self.port, self.web_port = port, web_port

    @property
    def pid(self) -> int:
        """The id of its process."""
        return self._process.pid

    @property
    def url(self) -> str:
        """The address for data."""
        return f"rerun+http://{LOOPBACK}:{self.port}/proxy"

    @property
    def page(self) -> str:
        """The address for a browser."""
        data = f"rerun%2Bhttp%3A%2F%2F{LOOPBACK}%3A{self.port}%2Fproxy"
        return f"http://{LOOPBACK}:{self.web_port}/?url={data}&renderer=webgl&hide_welcome_screen=1&theme=dark"

    def send(self, data: bytes, last: bool = False) -> bool:
        """Send more data to a viewer that was started without a recording; return whether it still runs."""
        assert self._process.stdin is not None, "started without a recording"
        try:
            self._process.stdin.write(data)
            self._process.stdin.flush()
            if last:
                self._process.stdin.close()
        except BrokenPipeError:
            return False
        return not self.closed

    def loaded(self) -> ViewerClient:
        """Wait until it shows a recording, and return a connection to it."""

        def showing() -> ViewerClient | None:
            client = ViewerClient.connect(self.url)
            state = client.get_state()
            return client if state.recordings and not state.loading else None

        return self._until("show the recording", showing)

    def serving(self) -> str:
        """Wait for its web page, and return the address."""

        def listening() -> str | None:
            with socket.create_connection((LOOPBACK, self.web_port), 1.0):
                return self.page

        return self._until("serve its page", listening)

    def wait(self) -> None:
        """Wait until it is closed.

        Raises:
            InputError: If it cannot run here, with what to install.
        """
        if self._process.wait() != 0:
            raise self._complaint()

    @property
    def closed(self) -> bool:
        """Whether it has ended."""
        return self._process.poll() is not None

    def _until(self, what: str, attempt: Callable[[], Found | None]) -> Found:
        """Repeat an attempt until it gives a result, and return that."""
        deadline = time.monotonic() + READY_S
        while time.monotonic() < deadline:
            if self.closed:
                raise self._complaint()
            with suppress(Exception):  # each library below has its own error for a viewer that does not listen yet
                found = attempt()
                if found is not None:
                    return found
            time.sleep(POLL_S)
        raise InternalError(f"the viewer did not {what} within {READY_S:.0f} s; it said:\n{self._last_words()}")

    def _complaint(self) -> InputError | InternalError:
        """Return why the viewer ended by itself."""
        said = self._last_words()
        if any(word in said for word in _DISPLAY_WORDS):
            return InputError([Fault("view", 0, 0, NO_DISPLAY)])
        if any(word in said for word in _DRIVER_WORDS):
            return InputError([Fault("view", 0, 0, NO_DRIVER)])
        return InternalError(f"the viewer ended with status {self._process.returncode}; it said:\n{said}")

    def _last_words(self) -> str:
        return self._said.read_text(encoding="utf-8", errors="replace")[-4000:]


@contextmanager
def viewer(kind: Literal["window", "headless", "web"], recording: Path | None = None) -> Iterator[Viewer]:
    """Run the viewer for a recording or for sent data; it ends with the block, and with this process.

    Raises:
        InputError: If a window is wanted and there is no display.
    """
    if kind == "window" and not has_display():
        raise InputError([Fault("view", 0, 0, NO_DISPLAY)])
    with tempfile.TemporaryDirectory(prefix="skolem-view-", ignore_cleanup_errors=True) as home:
        port, web_port = free_port(), free_port() if kind == "web" else 0
        said = Path(home, "said")
        with said.open("wb") as output:
            process = subprocess.Popen(
                [binary(), *_arguments(kind, port, web_port), "-" if recording is None else recording.resolve()],
                env=private_environment(Path(home)),
                stdin=subprocess.PIPE if recording is None else subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                preexec_fn=end_with_parent,
            )
        try:
            yield Viewer(process, said, port, web_port)
        finally:
            end(process)
            if process.stdin is not None:
                with suppress(BrokenPipeError):  # the viewer may have ended before it read everything
                    process.stdin.close()


def shoot(recording: Path, picture: Path, moment: Moment | None) -> list[str]:
    """Draw a recording at a moment (None: its end) as a PNG file, without a display; return the faults of the picture.

    Raises:
        InputError: If the viewer cannot run here, with what to install, or the picture cannot be written.
    """
    refuse_unwritable(picture)
    with viewer("headless", recording) as running:
        client = running.loaded()
        if moment is not None and moment[0] == "step":
            client.set_time(STEP, sequence=moment[1], play_state="paused")
        elif moment is not None:
            client.set_time(SIM_TIME, duration=moment[1], play_state="paused")
        drawn = Image.open(BytesIO(_settled(client)))
        smaller = BytesIO()
        drawn.convert("RGB").save(smaller, format="PNG", optimize=True)  # a third smaller than the viewer's file
        put(picture, smaller.getvalue())
        return complaints(client)


def _settled(client: ViewerClient) -> bytes:
    """Wait until meshes and labels are drawn and the picture is stable, and return it as PNG."""
    deadline = time.monotonic() + SETTLE_S
    time.sleep(DRAW_S)
    before, now = b"", client.take_screenshot()
    while now != before and time.monotonic() < deadline:
        time.sleep(STILL_S)
        before, now = now, client.take_screenshot()
    return now


def complaints(client: ViewerClient) -> list[str]:
    """Return the errors that views report and the viewer logs."""
    reports = [f"{view.name}: {report}" for view in client.get_state().views for report in view.reports]
    return reports + [entry.message for entry in client.get_logs() if entry.level.upper() == "ERROR"]


def free_port() -> int:
    """Return a port on which nobody listens now."""
    with socket.socket() as probe:
        probe.bind((LOOPBACK, 0))
        return int(probe.getsockname()[1])


def private_environment(home: Path) -> dict[str, str]:
    """Return environment variables for a viewer that keeps its files in `home` and sends no statistics."""
    (home / "rerun").mkdir(parents=True)
    (home / "rerun" / "analytics.json").write_text(json.dumps({"analytics_enabled": False}), encoding="utf-8")
    return os.environ | {"CI": "1", "XDG_CONFIG_HOME": str(home), "XDG_DATA_HOME": str(home), "RUST_LOG": "warn"}


def binary() -> Path:
    """Return the viewer's executable."""
    package = find_spec("rerun_cli")
    folders = [] if package is None else list(package.submodule_search_locations or ())
    found = shutil.which("rerun", path=os.pathsep.join(folders))
    if found is None:
        raise InternalError("package rerun-sdk holds no executable rerun_cli/rerun")
    return Path(found)


def _arguments(kind: str, port: int, web_port: int) -> Sequence[str]:
    """Return the viewer's options."""
    always = ["--bind", LOOPBACK, "--port", str(port), "--window-size", WINDOW, "--hide-welcome-screen"]
    return {
        "window": always,
        "headless": ["--headless", *always],
        "web": ["--serve-web", "--web-viewer-port", str(web_port), *always[:4]],
    }[kind]

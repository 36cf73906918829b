"""A browser controlled over its debugging pipe: it opens a page and takes pictures of it. It renders in software."""

import base64
import json
import os
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

OPTIONS = (
    "--headless=new",
    "--no-sandbox",
    "--no-first-run",
    "--remote-debugging-pipe",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
)


class Page:
    """A page in a running browser."""

    def __init__(self, to_browser: int, from_browser: int, address: str) -> None:
        self._out, self._in = to_browser, os.fdopen(from_browser, "rb", closefd=False)
        self._count = 0
        self._session: str | None = None
        target = self._call("Target.createTarget", url=address)["targetId"]
        self._session = self._call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]

    def picture(self) -> bytes:
        """Return a picture of the page as PNG."""
        return base64.b64decode(self._call("Page.captureScreenshot", format="png")["data"])

    def _call(self, method: str, **params: Any) -> Any:
        """Send a command and return its result; events in between are ignored."""
        self._count += 1
        session = {"sessionId": self._session} if self._session else {}
        command = {"id": self._count, "method": method, "params": params} | session
        os.write(self._out, json.dumps(command).encode() + b"\0")
        while (reply := json.loads(self._message())).get("id") != self._count:
            pass
        assert "error" not in reply, reply["error"]
        return reply["result"]

    def _message(self) -> bytes:
        found = bytearray()
        while (byte := self._in.read(1)) != b"\0":
            assert byte, "the browser ended"
            found += byte
        return bytes(found)


@contextmanager
def page(browser: str, address: str, width: int, height: int) -> Iterator[Page]:
    """Open a page in a new browser with a new profile; both are removed after the block."""
    down_read, down_write = os.pipe()
    up_read, up_write = os.pipe()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as home:
        places = [f"--user-data-dir={home}", f"--window-size={width},{height}", "about:blank"]
        shell = f'exec "$@" 3<&{down_read} 4>&{up_write}'  # the browser reads 3 and writes 4
        process = subprocess.Popen(
            ["bash", "-c", shell, "bash", browser, *OPTIONS, *places],
            pass_fds=(down_read, up_write),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(down_read)
        os.close(up_write)
        try:
            yield Page(down_write, up_read, address)
        finally:
            process.terminate()
            process.wait(20)
            os.close(down_write)
            os.close(up_read)

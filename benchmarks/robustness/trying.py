"""One input in a process of its own: how the command ended, what it said, and what it took."""

import faulthandler
import os
import resource
import signal
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal, NoReturn

from benchmarks.robustness.inputs import Case

CPU_S: Final = 10  # of computing, after which a command counts as hanging
WALL_S: Final = 120
LARGE_BYTES: Final = 1 << 30
Ending = Literal["verdict", "refused well", "refused badly", "internal error", "hang", "over 1 GB"]
ENDINGS: Final[tuple[Ending, ...]] = ("verdict", "refused well", "refused badly", "internal error", "hang", "over 1 GB")
REFUSED: Final = (2, 3)


@dataclass(frozen=True, slots=True)
class Tried:
    """How a command ended, and the last that it said."""

    ending: Ending
    status: int
    said: str


def tried(case: Case) -> Tried:
    """Do a command in a new folder and a child process, and return how it ended."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        work = folder / "work"
        work.mkdir()
        for file, content in case.files.items():
            (work / file).write_bytes(content)
        with (folder / "out").open("wb") as out, (folder / "err").open("wb") as err:
            sys.stdout.flush()
            pid = os.fork()
            if pid == 0:
                _do(case, work, out.fileno(), err.fileno())
            _, status, used = os.wait4(pid, 0)
        return _judged(status, used, (folder / "out").read_bytes(), (folder / "err").read_bytes())


def _do(case: Case, folder: Path, out: int, err: int) -> NoReturn:
    """Do the command in the child process, which ends with it."""
    status = 99
    try:
        faulthandler.disable()
        os.chdir(folder)
        nothing = os.open(os.devnull, os.O_RDONLY)
        for number, stream in ((nothing, 0), (out, 1), (err, 2)):
            os.dup2(number, stream)
        sys.stdout = open(1, "w", closefd=False, encoding="utf-8", errors="backslashreplace")
        sys.stderr = open(2, "w", closefd=False, encoding="utf-8", errors="backslashreplace")
        sys.argv = ["skolem", *case.arguments]
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        spent = resource.getrusage(resource.RUSAGE_SELF)
        resource.setrlimit(resource.RLIMIT_CPU, (int(spent.ru_utime + spent.ru_stime) + CPU_S,) * 2)
        signal.alarm(WALL_S)
        from skolem.tools.cli import main

        status = main()
        sys.stdout.flush()
        sys.stderr.flush()
    finally:
        os._exit(status)


def _judged(status: int, used: resource.struct_rusage, out: bytes, err: bytes) -> Tried:
    code, said = os.waitstatus_to_exitcode(status), err.decode("utf-8", "replace")
    last = said.strip()[-400:]
    if used.ru_maxrss << 10 > LARGE_BYTES:
        return Tried("over 1 GB", code, last)
    if code in (-signal.SIGXCPU, -signal.SIGKILL, 130):
        return Tried("hang", code, last)
    if code in (0, 1):
        return Tried("verdict", code, last)
    if code in REFUSED:
        shown = said + out.decode("utf-8", "replace")
        clear = shown.strip() and "Traceback" not in shown and all(c.isprintable() or c == "\n" for c in shown)
        return Tried("refused well" if clear else "refused badly", code, last)
    return Tried("internal error", code, last)

"""Files that are written: each is whole under its name or not there at all, and no link leads the writing elsewhere.

May import: nothing.
"""

import errno
import fcntl
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from skolem.traces.errors import Fault, InputError


def refuse_special(path: Path) -> None:
    """Refuse what is no file: a finished file is renamed to this path and would replace it.

    A link is refused as well: whoever gives one may not know where it leads, as of `/dev/stdout`.

    Raises:
        InputError: If the path is a link, a folder, a device, a pipe or a socket.
    """
    if os.path.islink(path):  # False for a path without permission, where pathlib raises
        raise InputError([Fault(str(path), 0, 0, "is a symbolic link; give the name of the file that is meant")])
    if os.path.isdir(path):
        raise InputError([Fault(str(path), 0, 0, "is a folder; give the name of a file")])
    if os.path.exists(path) and not os.path.isfile(path):
        raise InputError([Fault(str(path), 0, 0, "is a device, a pipe or a socket; give the name of a file")])


def created(path: Path) -> IO[bytes]:
    """Return a new file, open for writing; missing folders are made.

    Raises:
        OSError: If the path exists, be it as a link that leads nowhere, or cannot be created.
    """
    _make_folder_of(path)
    return path.open("xb")


def give_name(draft: Path, path: Path) -> None:
    """Move a finished file to its path, in the place of an older one.

    Raises:
        InputError: If the path is no file, as `refuse_special` says.
        OSError: If the file cannot be moved.
    """
    refuse_special(path)
    draft.replace(path)


@contextmanager
def placed(path: Path) -> Iterator[Path]:
    """Give the block a path to write to, and move what it wrote to `path` in the end; nothing, if the block raises.

    The block writes in a new folder beside `path`, which nobody else can write to.

    Raises:
        InputError: If `path` is no file, or cannot be written.
    """
    refuse_special(path)
    try:
        _make_folder_of(path)
        with tempfile.TemporaryDirectory(prefix=".skolem-", dir=path.parent) as folder:
            draft = Path(folder, path.name)
            yield draft
            give_name(draft, path)
    except OSError as error:
        raise unwritable(path, error) from error


@contextmanager
def locked(folder: Path, name: str) -> Iterator[None]:
    """Let nobody else into the same block for the same folder; a process that has died holds nobody back.

    Args:
        folder: The folder; it is made if it is missing.
        name: Name of the file in it that is locked; it stays.

    Raises:
        InputError: If another process is in the block, or the file cannot be written.
    """
    path = folder / name
    try:
        _make_folder_of(path)
        file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC, 0o666)
    except OSError as error:
        raise unwritable(path, error) from error
    with open(file, "r+b") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            said = f"is in use by process {lock.read(20).decode('ascii', 'replace').strip() or '?'}"
            raise InputError([Fault(str(folder), 0, 0, f"{said}; wait for it, or give another folder")]) from None
        except OSError as error:
            raise unwritable(path, error) from error
        lock.truncate()
        lock.write(b"%d\n" % os.getpid())
        lock.flush()
        yield


def put(path: Path, data: bytes) -> None:
    """Write a file, in the place of an older one.

    Raises:
        InputError: As `placed`.
    """
    with placed(path) as draft:
        draft.write_bytes(data)


def refuse_unwritable(path: Path) -> None:
    """Refuse a path to which no file can be written, before the work that is to be written there; make its folder.

    Raises:
        InputError: As `placed`.
    """
    refuse_special(path)
    try:
        _make_folder_of(path)
        with tempfile.TemporaryDirectory(prefix=".skolem-", dir=path.parent) as folder:
            Path(folder, path.name).touch()
    except OSError as error:
        raise unwritable(path, error) from error


def _make_folder_of(path: Path) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except FileExistsError as error:  # it would say that the path itself exists
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR)) from error


def unwritable(path: Path, error: OSError) -> InputError:
    """Return the fault of a path to which nothing can be written."""
    return InputError([Fault(str(path), 0, 0, f"cannot be written: {error.strerror or error}")])

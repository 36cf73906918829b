"""Files that people name, or that other files name: only regular ones are opened, and never more is read than may be.

May import: nothing.
"""

import errno
import os
import stat
from pathlib import Path
from typing import IO


def opened_regular(path: Path) -> IO[bytes]:
    """Return a regular file, opened for reading; nobody waits for a pipe, and no device is touched.

    Raises:
        OSError: If it cannot be read, or is a folder, a pipe, a socket or a device.
    """
    _refuse_special(os.stat(path).st_mode)
    file = os.fdopen(os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC), "rb")
    try:
        _refuse_special(os.fstat(file.fileno()).st_mode)  # it may be another one by now
    except OSError:
        file.close()
        raise
    return file


def read_regular(path: Path, most: int) -> bytes:
    """Return the content of a regular file; of a longer one the first `most` bytes and one more, by which it shows.

    Raises:
        OSError: As `opened_regular`.
    """
    with opened_regular(path) as file:
        return file.read(most + 1)


def _refuse_special(mode: int) -> None:
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if not stat.S_ISREG(mode):
        raise OSError(errno.EINVAL, "not a regular file")

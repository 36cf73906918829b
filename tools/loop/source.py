"""The hash of the program that computes a run, over the files that decide what happens in it."""

import hashlib
from pathlib import Path
from typing import Final

DECISIVE: Final = (
    "rules/*.lp",
    "reasoner/**/*.py",
    "estimation/**/*.py",
    "sim/**/*.py",
    "traces/**/*.py",
    "tools/loop/*.py",
)


def source_sha256(root: Path) -> str:
    """Return the hash of the names and contents of the decisive files.

    Args:
        root: The folder that holds `rules`, `reasoner` and so on: a checkout, or the installed `skolem`.
    """
    digest = hashlib.sha256()
    for path in sorted(path for pattern in DECISIVE for path in root.glob(pattern)):
        content = path.read_bytes()
        digest.update(f"{path.relative_to(root).as_posix()} {len(content)}\n".encode() + content)
    return digest.hexdigest()


# computed once, on import: a long-lived process runs the files that it has loaded, not those saved since
SOURCE_SHA256: Final = source_sha256(Path(__file__).parents[2])

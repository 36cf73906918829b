"""The rules of a recorded run, as they are attached to its trace or with some files replaced."""

import tempfile
from collections.abc import Mapping
from pathlib import Path

from skolem.reasoner.queries import Queries
from skolem.reasoner.rulebook import RULE_FILES, Rulebook
from skolem.reasoner.validate import RuleFile
from skolem.traces.errors import Fault, InputError

_FOLDER = "rules/"


def rulebook_of(attachments: Mapping[str, bytes]) -> Rulebook:
    """Return the rules of a run, from the attachments of its trace.

    Raises:
        InputError: With every fault in every file.
    """
    return Rulebooks().of(attachments)


class Rulebooks:
    """The rules of recorded runs; runs with the same rule files share them, which saves half of the work."""

    def __init__(self) -> None:
        self._known: dict[tuple[tuple[str, bytes], ...], Rulebook] = {}

    def of(self, attachments: Mapping[str, bytes], replaced: Mapping[str, bytes] | None = None) -> Rulebook:
        """Return the rules of a run.

        Args:
            attachments: Of its trace.
            replaced: File name to content, of the files that are to be taken instead or beside.

        Raises:
            InputError: With every fault in every file.
        """
        attached = {name.removeprefix(_FOLDER): data for name, data in attachments.items() if name.startswith(_FOLDER)}
        files = attached | dict(replaced or {})
        key = tuple(sorted(files.items()))
        if key not in self._known:
            rulebook = _read(files)
            if replaced:
                from skolem.reasoner.linting import refuse_wrong  # takes time, and other replays do without

                refuse_wrong(rulebook)
            self._known[key] = rulebook
        return self._known[key]


def _read(files: Mapping[str, bytes]) -> Rulebook:
    shipped = [f"{name}.lp" for name in RULE_FILES]
    order = [*(name for name in shipped if name in files), *sorted(files.keys() - set(shipped))]
    with tempfile.TemporaryDirectory() as folder:  # clingo reads files
        return Rulebook.of(Queries, [_written(Path(folder), name, files[name], name not in shipped) for name in order])


def _written(folder: Path, name: str, content: bytes, own: bool) -> RuleFile:
    """Write a rule file for clingo, and return it."""
    path = folder / name
    path.write_bytes(content)
    return RuleFile(path.stem, _FOLDER + name, str(path), content, own)


def files_in(folder: Path) -> dict[str, bytes]:
    """Return the rule files of a folder by name.

    Raises:
        InputError: If there are none, or one cannot be read.
    """
    try:
        found = {path.name: path.read_bytes() for path in sorted(folder.glob("*.lp"))}
    except OSError as error:
        raise InputError([Fault(str(error.filename), 0, 0, f"cannot be read: {error.strerror}")]) from error
    if not found:
        raise InputError([Fault(str(folder), 0, 0, "no rule files (*.lp) here; expected a folder such as rules/")])
    return found

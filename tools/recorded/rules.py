"""The rules of a recorded run: the attachments of its trace, with some files replaced if asked."""

import re
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import RULE_FILES, Rulebook, rule_files
from skolem.reasoner.rulebook.files import MAX_BYTES, RuleFile
from skolem.traces.errors import Fault, InputError
from skolem.traces.file.made_of import RULES
from skolem.traces.given import read_regular


@dataclass(frozen=True, slots=True)
class Overlay:
    """The effect of a user's rule files on those of a trace, by file name.

    Attributes:
        changed: Files with another text.
        added: Files that the trace does not have.
        kept: Files of the trace that the user does not have: perhaps deleted, or renamed.
    """

    changed: tuple[str, ...]
    added: tuple[str, ...]
    kept: tuple[str, ...]

    @classmethod
    def of(cls, attachments: Mapping[str, bytes], replaced: Mapping[str, bytes]) -> "Overlay":
        """Compare the user's files with those of a trace."""
        own = _attached(attachments)
        changed = sorted(name for name in own.keys() & replaced.keys() if own[name] != replaced[name])
        added, kept = sorted(replaced.keys() - own.keys()), sorted(own.keys() - replaced.keys())
        return cls(tuple(changed), tuple(added), tuple(kept))

    def __str__(self) -> str:
        said = (("changed", self.changed), ("added", self.added), ("not in DIR, taken from the trace", self.kept))
        parts = [f"{what}: {', '.join(names)}" for what, names in said if names]
        return f"rules {'; '.join(parts)}" if parts else "rules as in the trace"


def rulebook_of(attachments: Mapping[str, bytes]) -> Rulebook:
    """Return the rules of a run, from the attachments of its trace.

    Raises:
        InputError: With every fault in every file.
    """
    return Rulebooks().of(attachments)


class Rulebooks:
    """A cache of the rules of recorded runs; runs with the same files share them, which saves half of the work."""

    def __init__(self, folder: Path | None = None) -> None:
        """Start with an empty cache.

        Args:
            folder: Folder of the user's files, which faults name; None: faults name them as files of the trace.
        """
        self._folder = RULES if folder is None else f"{folder}/"
        self._known: dict[tuple[tuple[str, bytes], ...], Rulebook] = {}

    def of(self, attachments: Mapping[str, bytes], replaced: Mapping[str, bytes] | None = None) -> Rulebook:
        """Return the rules of a run.

        Args:
            attachments: Attachments of its trace.
            replaced: File name to content of the files that replace others or are added.

        Raises:
            InputError: With every fault in every file.
        """
        replaced = replaced or {}
        files = _attached(attachments) | dict(replaced)
        key = tuple(sorted(files.items()))
        if key not in self._known:
            titles = {name: (self._folder if name in replaced else RULES) + name for name in files}
            try:
                rulebook = _read(files, titles, steps=bool(replaced))
            except InputError as error:
                hints = self._hints(error.faults, Overlay.of(attachments, replaced).kept if replaced else ())
                raise InputError([*error.faults, *hints]) from error
            self._known[key] = rulebook
        return self._known[key]

    def _hints(self, faults: Sequence[Fault], kept: Sequence[str]) -> Iterator[Fault]:
        """Yield a hint for each faulty file that only the trace has: where it comes from, and how to leave it out."""
        for name in kept:
            if any(RULES + name in (fault.file, *re.findall(r"[^\s:]+", fault.message)) for fault in faults):
                said = f"is not there, so it is taken from the trace as {RULES}{name}; an empty file leaves it out"
                yield Fault(self._folder + name, 0, 0, said)


def _attached(attachments: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return the rule files among the attachments of a trace, by file name."""
    return {name.removeprefix(RULES): data for name, data in attachments.items() if name.startswith(RULES)}


def _read(files: Mapping[str, bytes], titles: Mapping[str, str], steps: bool) -> Rulebook:
    """Return the rules in `files`; faults name them by their titles, not by the paths that clingo reads.

    Args:
        files: Content of each file by its name.
        titles: Title of each file by its name.
        steps: Whether to refuse rules that would stop a run; those of a recorded run have not stopped it.
    """
    ships = {(f"{file.name}.lp", file.content): file for file in rule_files()[0]}
    shipped = [f"{name}.lp" for name in RULE_FILES]
    order = [*(name for name in shipped if name in files), *sorted(files.keys() - set(shipped))]
    with tempfile.TemporaryDirectory() as folder:  # clingo reads files
        sources = []
        for number, name in enumerate(order):
            source = ships.get((name, files[name]))
            if source is None:
                path = Path(folder) / f"{number}.lp"  # a name from a trace must not decide the path
                path.write_bytes(files[name])
                own = name not in shipped
                source = RuleFile(name.removesuffix(".lp"), titles[name], str(path), files[name], own)
            sources.append(source)
        try:
            if all(file.ships for file in sources):
                return Rulebook.of(Queries, sources)
            from skolem.tools.loop.apart import rulebook_of as bounded  # takes time, and other replays do without

            return bounded(sources, steps)
        except InputError as error:
            raise InputError(_retold(fault, sources) for fault in error.faults) from error


def _retold(fault: Fault, sources: Sequence[RuleFile]) -> Fault:
    """Return a fault whose message, too, names files by their titles."""
    for source in sources:
        fault = replace(fault, message=fault.message.replace(source.path, source.title))
    return fault


def files_in(folder: Path) -> dict[str, bytes]:
    """Return the rule files of a folder by name.

    Raises:
        InputError: If there is no rule file, or one cannot be read.
    """
    try:
        found = {path.name: read_regular(path, MAX_BYTES) for path in sorted(folder.glob("*.lp"))}
    except OSError as error:
        raise InputError([Fault(str(error.filename), 0, 0, f"cannot be read: {error.strerror}")]) from error
    if not found:
        raise InputError([Fault(str(folder), 0, 0, "no rule files (*.lp) here; expected a folder such as rules/")])
    return found

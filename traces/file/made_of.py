"""The inputs of a run: the files and metadata in its trace, compared with the hashes in its start."""

import hashlib
import re
from collections.abc import Iterator, Mapping
from typing import Final

from skolem.traces.messages import RunStart

SCENARIO: Final = "scenario.yaml"
RULES: Final = "rules/"
NOT_ATTACHED: Final = "but not attached"
_FILE: Final = re.compile(r"(?!\.)[^/\\\x00-\x1f\x7f]{1,200}\.lp")  # the name of a rule file, without folder


def digest(content: bytes) -> str:
    """Return the hash by which the start of a run names a file."""
    return hashlib.sha256(content).hexdigest()


def disagreements(start: RunStart, attached: Mapping[str, str], run: Mapping[str, str]) -> Iterator[str]:
    """Yield every difference between the scenario, rules and metadata in a trace and those of its run.

    Args:
        start: The start of the run.
        attached: The hash of every attached file, by name.
        run: The metadata of the run.
    """
    expected = {f"{RULES}{name}": digest for name, digest in start.rules_sha256.items()}
    expected[SCENARIO] = start.scenario_sha256
    for name in sorted(attached.keys() | expected.keys()):
        if name != SCENARIO and not (name.startswith(RULES) and _FILE.fullmatch(name.removeprefix(RULES))):
            yield f"{name!r} is not the name of a rule file"
        elif name not in attached:
            yield f"{name} is named, {NOT_ATTACHED}"
        elif name not in expected:
            yield f"{name} is attached, but not named"
        elif attached[name] != expected[name]:
            yield f"{name} differs from the attached file"
    for name, value in (("scenario", start.scenario), ("seed", str(start.seed)), ("world", start.world)):
        if run.get(name, value) != value:
            yield f"the metadata say {name} {run[name]}, the start of the run says {value}"

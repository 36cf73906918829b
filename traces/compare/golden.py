"""Golden traces, which hold the decisions of recorded runs for the tests, and the manifest that describes them."""

import json
import tomllib
from collections.abc import Mapping
from pathlib import Path

from mcap.records import Channel, Chunk, DataEnd, Message as McapMessage, Metadata, Schema

from skolem.traces.errors import Fault, InputError
from skolem.traces.file.codec import CONTENT, ContentHash, counter_of
from skolem.traces.file.container import Copy, contents, pieces
from skolem.traces.file.reader import opened
from skolem.traces.given import read_regular
from skolem.traces.messages import Message, WorldName
from skolem.traces.written import put

MANIFEST = "MANIFEST.toml"
MAX_BYTES = 220_000  # of one golden trace; rules, scenario and schemas take about half of it
LONGEST = 1 << 20  # bytes of a manifest
ONE_CHUNK_BYTES = 1 << 26  # a golden trace is one chunk: what repeats in every step compresses best in one piece
HEAD = """# Recorded runs that every version must decide in the same way. Made by `skolem trace bless`, never by hand.
# A table per trace: what was run, what it is for, why it was changed last, and what is in it.
"""


class Golden(Message):
    """The manifest's description of one golden trace: the recipe, and the result once the trace is made.

    Attributes:
        scenario: Path of the scenario file, from the root of the checkout.
        seed: Seed of every random draw.
        world: Name of the simulator.
        overrides: Changed values of the scenario, each `a.b=value`.
        why: Purpose of this trace.
        reason: Why the trace was made, or changed last.
        decision_hash: Hash of what the robot sensed, believed and decided.
        status: How the run ended.
        steps: Executed actions.
        operators: Operators and inference rules in its plans, sorted.
        causes: Why its plan stack changed, sorted.
    """

    scenario: str
    seed: int
    world: WorldName
    overrides: tuple[str, ...]
    why: str
    reason: str = ""
    decision_hash: str = ""
    status: str = ""
    steps: int = 0
    operators: tuple[str, ...] = ()
    causes: tuple[str, ...] = ()


def read_manifest(folder: Path) -> dict[str, Golden]:
    """Return the golden traces of a folder by name, in the order of the manifest.

    Raises:
        InputError: If there is no manifest, or it cannot be read.
    """
    path = folder / MANIFEST
    try:
        entries = tomllib.loads(read_regular(path, LONGEST).decode("utf-8"))
        return {name: Golden.model_validate_json(json.dumps(entry)) for name, entry in entries.items()}
    except OSError as error:
        raise InputError([Fault(str(path), 0, 0, f"cannot be read: {error.strerror}")]) from error
    except ValueError as error:
        raise InputError([Fault(str(path), 0, 0, f"is not a manifest: {error}")]) from error


def write_manifest(folder: Path, goldens: Mapping[str, Golden]) -> None:
    """Write the manifest of a folder, sorted by name."""
    entries = [HEAD, *(_entry(name, goldens[name]) for name in sorted(goldens))]
    put(folder / MANIFEST, "\n".join(entries).encode())


def is_text(value: str) -> bool:
    """Return whether a manifest can hold a text; a text from the command line may hold bytes that are no characters."""
    return not any("\ud800" <= c <= "\udfff" for c in value)


def golden_path(folder: Path, name: str) -> Path:
    """Return the path of a golden trace."""
    return folder / f"{name}.mcap"


def keep_decisions(source: Path, target: Path) -> None:
    """Copy a trace without the truth and without wall times.

    The decision hash stays the same; the content hash becomes the one of the copied messages.

    Raises:
        TraceError: If `source` cannot be read.
        InputError: If `target` cannot be written.
    """
    with opened(source) as file, Copy(target, ONE_CHUNK_BYTES) as copy:
        schemas: dict[int, Schema] = {}
        kept = ContentHash()
        for piece in pieces(file):
            if isinstance(piece.record, DataEnd):
                break
            for record in contents(piece) if isinstance(piece.record, Chunk) else [piece.record]:
                _copy_decision(record, schemas, copy, kept)
        copy.end_chunk()
        copy.add(Metadata(CONTENT, kept.metadata))


def _copy_decision(record: object, schemas: dict[int, Schema], copy: Copy, kept: ContentHash) -> None:
    """Copy a record; leave out channels without decisions, and their messages."""
    match record:
        case Schema(id=number):
            schemas[number] = record
        case Channel(topic=topic, schema_id=number):
            if counter_of(topic) == "decision":
                copy.add(schemas[number])
                copy.add(record)
        case McapMessage(channel_id=number):
            if copy.knows(number):
                copy.add(record)
                kept.add(copy.topic(number), record.data, record.log_time, record.sequence)
        case Metadata(name=name) if name == CONTENT:
            pass
        case _:
            copy.add(record)


def _entry(name: str, golden: Golden) -> str:
    fields = golden.model_dump(mode="json")
    return "\n".join([f"[{name}]", *(f"{key} = {_toml(value)}" for key, value in fields.items()), ""])


def _toml(value: object) -> str:
    """Return a value in TOML, which writes strings, numbers and arrays as JSON does, but for one character."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")

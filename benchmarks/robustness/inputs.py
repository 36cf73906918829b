"""Generated inputs of each kind: most of them sound in their structure, so that what lies behind the readers is met."""

import json
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from random import Random
from typing import Any, Final

from mcap.records import Attachment, Message, Metadata
from ruamel.yaml import YAML

from benchmarks.robustness.values import HOSTILE, changed, garbled
from skolem.tools.cli import VERBS
from skolem.tools.loop.session import run
from skolem.tools.loop.setup import prepare
from skolem.traces.file.container import Copy
from skolem.traces.file.writer import CHUNK_BYTES

ROOT: Final = Path(__file__).parents[2]
RECORDED: Final = 3  # runs whose traces are changed
STEPS: Final = 2  # of a run: the readers are tried here, not the robot
OPTIONS: Final = {  # of each verb, those with a value
    "run": ("--seed", "--set", "--max-steps", "-o", "--out"),
    "show": ("--step", "--object"),
    "explain": ("--step", "--why-not", "--object"),
    "replay": ("--set", "--rules", "--atol", "--rtol", "--workers"),
    "reproduce": ("--atol", "--rtol", "--keep"),
    "generate": ("--seed", "--bound", "-o"),
    "recover": ("-o",),
}
HOSTILE_SHARE: Final = 0.4  # of the inputs that have a change which is not mild
WORDS: Final = ("Black", "Blue", "Bottle", "Can", "Green", "Grey", "Heavy", "Light", "Purple", "Red", "Soda")
PLACES: Final = (*["table1"] * 15, "nowhere")


@dataclass(frozen=True, slots=True)
class Case:
    """A command, in a folder with files.

    Attributes:
        arguments: The words after `skolem`.
        files: The files that it finds, by name.
    """

    arguments: tuple[str, ...]
    files: Mapping[str, bytes]


def scenario(draw: Random) -> Case:
    """Return a run of a scenario that ships, with changed values."""
    hostile = draw.random() < HOSTILE_SHARE
    tree = _scenarios()[draw.randrange(len(_scenarios()))]
    text = _as_text(_short(changed(tree, draw, 0.9 if hostile else 0.0)))
    if hostile and draw.random() < 0.15:
        text = garbled(text, draw)
    return Case(
        ("run", "s.yaml", "--world", "symbolic", "-q", "-o", "a.mcap"), {"s.yaml": text.encode("utf-8", "replace")}
    )


def goal(draw: Random) -> Case:
    """Return a run of a scenario with a drawn goal."""
    text = _goal(draw)
    if draw.random() < HOSTILE_SHARE:
        text = garbled(text, draw)
    fit = [tree for tree in _scenarios() if "table1" in tree["goal"]]
    tree = _short({**draw.choice(fit), "goal": text, "expect": None})
    del tree["expect"]
    return Case(
        ("run", "s.yaml", "--world", "symbolic", "-q", "-o", "a.mcap"),
        {"s.yaml": _as_text(tree).encode("utf-8", "replace")},
    )


def rules(draw: Random) -> Case:
    """Return a check, or sometimes a run, of rule files: pieces of those that ship, and new rules."""
    odd = draw.random() < HOSTILE_SHARE
    lines = [_odd_rule(draw) if odd and draw.random() < 0.5 else _sound_rule(draw) for _ in range(draw.randint(1, 4))]
    if draw.random() < 0.1:
        shipped = draw.choice(sorted((ROOT / "rules").glob("*.lp"))).read_text(encoding="utf-8").splitlines()
        begin = draw.randrange(len(shipped))
        lines += shipped[begin : begin + draw.randint(1, 8)]
    text = "\n".join(lines) + "\n"
    if draw.random() < HOSTILE_SHARE / 2:
        text = garbled(text, draw)
    files = {"r.lp": text.encode("utf-8", "replace")}
    if draw.random() < 0.8:
        return Case(("rules", "check", "r.lp"), files)
    tree = _short(_scenarios()[0]) | {"rules": ["r.lp"]}
    return Case(
        ("run", "s.yaml", "--world", "symbolic", "-q", "-o", "a.mcap"), files | {"s.yaml": _as_text(tree).encode()}
    )


def trace(draw: Random, folder: Path) -> Case:
    """Return a look at a trace that was changed in its bytes, its records or its messages."""
    source = folder / "source.mcap"
    source.write_bytes(data := recorded(draw.randrange(RECORDED)))
    kind = draw.randrange(4)
    if kind == 1:
        data = _damaged(data, draw)
    elif kind > 1:
        data = _edited(source, folder, draw)
    verb = draw.choice(
        (
            ("check",),
            ("show",),
            ("info",),
            ("explain",),
            ("replay",),
            ("show", "--step", "1"),
            ("explain", "--step", "1"),
        )
    )
    out: tuple[str, ...] = ()
    if draw.random() < 0.1:
        verb, out = ("recover",), ("-o", "good.mcap")
    return Case((verb[0], "t.mcap", *verb[1:], *out), {"t.mcap": data})


def command(draw: Random) -> Case:
    """Return a command line of a known verb with drawn options and values."""
    files = {
        "s.yaml": _as_text(_short(_scenarios()[0])).encode(),
        "r.lp": b"colour(mossy, 90, 150, 40, 100, 20, 100).\n",
    }
    files["t.mcap"] = recorded(0)
    verb = draw.choice([name for name in VERBS if name not in ("view", "sweep", "trace")])
    words = [verb, *(["check"] if verb in ("rules", "scenario") and draw.random() < 0.8 else [])]
    subject = {"run": "s.yaml", "rules": "r.lp", "scenario": "s.yaml", "generate": "three"}.get(verb, "t.mcap")
    words += [subject] if draw.random() < 0.9 else []
    options = (
        OPTIONS.get(verb, ("--json",))
        if draw.random() < 0.85
        else tuple(option for of in OPTIONS.values() for option in of)
    )
    values = (
        "0",
        "1",
        "2",
        "-1",
        "s.yaml",
        "t.mcap",
        "nowhere",
        "a.out",
        ".",
        "limits.steps=1",
        "goal=",
        "symbolic",
        "sodaC",
        "0.9",
    )
    for _ in range(draw.choice((0, 1, 1, 2, 3))):
        value = draw.choice(values) if draw.random() < 0.8 else str(draw.choice(HOSTILE))
        words += [draw.choice(options), value.replace("\x00", "0")]
    words += draw.sample(
        ["--json", "-q", "--raw", "--optimal", "--profile", "--images", "--help"], draw.choice((0, 0, 1, 2))
    )
    words += ["--world", "symbolic", "--max-steps", str(STEPS)] if verb == "run" else []
    return Case(tuple(words), files)


KINDS: Final[Mapping[str, Callable[[Random, Path], Case]]] = {
    "scenarios": lambda draw, _: scenario(draw),
    "goals": lambda draw, _: goal(draw),
    "rule files": lambda draw, _: rules(draw),
    "traces": trace,
    "command lines": lambda draw, _: command(draw),
}

_known: list[Any] = []


@cache
def recorded(seed: int) -> bytes:
    """Return the trace of a short run of this version."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "run.mcap")
        setup = prepare(ROOT / "scenarios" / "sim1_green.yaml", ["limits.steps=4"], seed, "symbolic")
        run(setup, path)
        return path.read_bytes()


def _scenarios() -> list[Any]:
    """Return the scenarios that ship, as trees."""
    if not _known:
        yaml = YAML(typ="safe")
        _known.extend(
            yaml.load(path.read_text(encoding="utf-8")) for path in sorted((ROOT / "scenarios").glob("*.yaml"))
        )
    return _known


def _short(tree: Any) -> Any:
    limits = tree.get("limits")
    return {**tree, "limits": {**limits, "steps": STEPS} if isinstance(limits, dict) else {"steps": STEPS}}


def _as_text(tree: Any) -> str:
    return json.dumps(tree, indent=1, default=str)


def _goal(draw: Random) -> str:
    names = ["o", "q"][: draw.choice((1, 1, 1, 2))]
    parts = []
    for number in range(draw.randint(len(names), 3)):
        name, bound = (
            names[number % len(names)],
            draw.choice((*("0.9", "0.8", "0.5", "0.95", "0.7") * 4, "0.99", "1.5")),
        )
        about = f"lambda x. {_described(draw, 'x', draw.choice((0, 0, 1, 3)))}"
        kinds = (f"Den({about}, {name})", f"In({name}, {draw.choice(PLACES)})", f"{draw.choice(WORDS)}({name})")
        parts.append(f"B({draw.choice(kinds)}, {bound})")
    return f"{' '.join(f'exists {name}.' for name in names)} {' & '.join(parts)}"


def _described(draw: Random, name: str, depth: int) -> str:
    if depth == 0:
        return draw.choice(
            (f"{draw.choice(WORDS)}({name})", f"On({name}, {draw.choice(PLACES)})", f"Near({name}, table1)")
        )
    one, other = _described(draw, name, depth - 1), _described(draw, name, draw.randrange(depth))
    return draw.choice(
        (f"({one} & {other})", f"({one} | {other})", f"exists y. (Near({name}, y) & {_described(draw, 'y', 0)})", one)
    )


def _odd_rule(draw: Random) -> str:
    """Return a rule that is wrong, grows, or asks for what it may not have."""
    name = draw.choice(("mossy", "dusty", "plain"))
    return draw.choice(
        (
            f"type({name}).",
            f"p({draw.randrange(9)}..{10 ** draw.randrange(12)}).",
            f"p(X) :- q(X), X < {draw.randrange(99)}.",
            f"p(f(X)) :- p(X), X != {name}.",
            f"{{ p(X) : q(X) }} {draw.randrange(3)}.",
            f"p(X, Y, Z) :- X = 1..{10 ** draw.randrange(6)}, Y = X, Z = Y ** {draw.randrange(5)}.",
            f"p({'f(' * (depth := draw.choice((1, 30, 900)))}1{')' * depth}).",
            "#show p/1.",
            '#include "/etc/passwd".',
            "#script (python) pass #end.",
        )
    )


def _sound_rule(draw: Random) -> str:
    """Return a word of its own, or a price of an action."""
    name, number, low = "".join(draw.choices("abcdefgh", k=6)), draw.randrange(999), draw.randrange(300)
    verb = draw.choice(("pick(_, O)", "place(O, _, _)"))
    return draw.choice(
        (
            f"colour({name}, {low}, {low + 40}, 40, 100, 20, 100).",
            f"weight({name}, {draw.randrange(100)}, {draw.randrange(100, 3000)}).",
            f"cost(S, {name}, {number}) :- step(S), S = {verb}, @rigid(O) = 1.",
            f"moved(S, O) :- step(S), S = {verb}.\ncost(S, {name}, 10) :- moved(S, O), @rigid(O) = 1.",
        )
    )


def _damaged(data: bytes, draw: Random) -> bytes:
    changed_bytes = bytearray(data)
    for _ in range(draw.choice((1, 1, 4))):
        begin = draw.randrange(len(changed_bytes))
        changed_bytes[begin : begin + draw.choice((0, 1, 8))] = draw.randbytes(draw.choice((0, 1, 8)))
    return bytes(changed_bytes[: draw.randrange(len(changed_bytes))] if draw.random() < 0.3 else changed_bytes)


def _edited(source: Path, folder: Path, draw: Random) -> bytes:
    """Return a trace with edited records in a sound container."""
    from kit.tampering import records_of

    records = records_of(source)
    messages = [number for number, record in enumerate(records) if isinstance(record, Message)]
    for _ in range(draw.choice((1, 1, 3))):
        number = draw.choice(messages) if draw.random() < 0.8 else draw.randrange(len(records))
        records[number : number + 1] = draw.choice(
            ([], [records[number]] * 2, [_other(records[number], draw)], [_other(records[number], draw)])
        )
        messages = [number for number, record in enumerate(records) if isinstance(record, Message)] or [0]
    target = folder / "edited"
    with Copy(target, CHUNK_BYTES) as copy:
        for record in records:
            if not isinstance(record, Message) or copy.knows(record.channel_id):
                copy.add(record)
    return target.read_bytes()


def _other(record: object, draw: Random) -> object:
    match record:
        case Message(channel_id, log_time, data, publish_time, sequence):
            try:
                data = json.dumps(
                    changed(json.loads(data), draw, 0.5), sort_keys=True, separators=(",", ":"), default=str
                ).encode("utf-8", "replace")
            except ValueError:
                data = _damaged(data, draw) if data else b"{"
            return Message(channel_id, log_time, data, publish_time, sequence + draw.choice((0, 0, 0, 1)))
        case Attachment(create_time, log_time, name, media_type, data):
            text = garbled(data.decode("utf-8", "replace"), draw)
            return Attachment(
                create_time, log_time, draw.choice((name, name, "../x")), media_type, text.encode("utf-8", "replace")
            )
        case Metadata(name, metadata):
            return Metadata(
                name, {key: draw.choice((value, "", "9" * 40, "\x1b[1m")) for key, value in metadata.items()}
            )
    return record

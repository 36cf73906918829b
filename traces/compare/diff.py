"""Comparison of two recorded runs: the first divergence, and how often each field differs.

Bytes are compared first; only messages whose bytes differ are decoded and compared by field. Integers, booleans
and strings must be equal; floats may differ by a tolerance, which is data (`tolerances.json`). Without one every byte
counts: 0.0 is not -0.0.
"""

import base64
import json
import re
from bisect import bisect_left
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache
from importlib import resources
from itertools import zip_longest
from typing import Any, Literal

from skolem.traces.errors import TraceError
from skolem.traces.file.codec import decode
from skolem.traces.file.reader import Recorded, Trace
from skolem.traces.messages import CLASS_OF, JSON_TOPICS, PERF

Kind = Literal["value", "order", "length"]
ABSENT = "(absent)"
SHOWN = 60  # characters of a value in a report
NOT_TIMED = tuple(topic for topic, kind in CLASS_OF.items() if kind != PERF)


@dataclass(frozen=True, slots=True)
class Tolerance:
    """How far two floats may lie apart: |a - b| <= max(atol, rtol max(|a|, |b|)).

    Attributes:
        atol: Absolute.
        rtol: Relative.
        fields: Exceptions (pattern, atol, rtol). A pattern is topic and path: `/belief*covariance*`; the first pattern
            that matches a field counts.
        ignored: Fields that are not compared, as topic and path: `/chain.chain`.
    """

    atol: float = 0.0
    rtol: float = 0.0
    fields: tuple[tuple[str, float, float], ...] = ()
    ignored: frozenset[str] = frozenset()

    @property
    def is_exact(self) -> bool:
        """Whether no difference at all is allowed."""
        return self == EXACT

    def with_floats(self, atol: float | None, rtol: float | None) -> "Tolerance":
        """Return the tolerance with these bounds for every float; hashes of floats are then not compared.

        If neither bound is given, return the tolerance as it is.
        """
        if atol is None and rtol is None:
            return self
        return Tolerance(atol or 0.0, rtol or 0.0, (), tolerance_for("other machine").ignored)

    def allows(self, field: str, a: float, b: float) -> bool:
        """Return whether two floats count as equal."""
        bounds = ((atol, rtol) for pattern, atol, rtol in self.fields if fnmatchcase(field, pattern))
        atol, rtol = next(bounds, (self.atol, self.rtol))
        if not (atol or rtol):
            return repr(a) == repr(b)  # 0.0 == -0.0, but their bytes differ
        return abs(a - b) <= max(atol, rtol * max(abs(a), abs(b)))


EXACT = Tolerance()


@cache
def tolerance_for(machine: Literal["equal machine", "other machine"]) -> Tolerance:
    """Return the tolerance for two runs of one machine, or of two machines, from `tolerances.json`."""
    text = (resources.files("skolem.traces.compare") / "tolerances.json").read_text(encoding="utf-8")
    table = json.loads(text)[machine]
    fields = tuple((row["field"], row["atol"], row["rtol"]) for row in table["fields"])
    return Tolerance(**table["default"], fields=fields, ignored=frozenset(table["ignored"]))


@dataclass(frozen=True, slots=True)
class Change:
    """A field that differs between two messages.

    Attributes:
        path: The field inside the message, `.objects.o1.world_T_object[0]`.
        expected: Its value in the first run.
        got: Its value in the second.
    """

    path: str
    expected: object
    got: object

    @property
    def difference(self) -> float | None:
        """The distance between the values; None if they are not numbers."""
        return abs(self.got - self.expected) if _number(self.expected) and _number(self.got) else None  # type: ignore[operator]

    def __str__(self) -> str:
        distance = "" if self.difference is None else f"  |d| = {self.difference:.3g}"
        return f"{self.path}: expected {_short(self.expected)}, got {_short(self.got)}{distance}"


@dataclass(frozen=True, slots=True)
class Divergence:
    """A place where two runs differ.

    Attributes:
        step: Number of the decision; -1 before the first.
        topic: Topic of the message in the first run, or of the surplus message in the second.
        kind: `value`: a field differs; `order`: the topics differ; `length`: one of the runs has no more messages.
        changes: The fields that differ; for `order` and `length` the topics.
    """

    step: int
    topic: str
    kind: Kind
    changes: tuple[Change, ...]

    def lines(self) -> list[str]:
        """Return the divergence in words."""
        more = f" ({len(self.changes)} fields)" if len(self.changes) > 1 else ""
        where = f"at step {self.step}" if self.step >= 0 else "before the first decision"
        return [f"DIVERGED {where}, {self.topic}: {self.kind}{more}", *(f"  {change}" for change in self.changes[:3])]


class Comparison:
    """Compares two runs step by step and keeps their differences.

    Attributes:
        compared: Number of messages, by topic; a message that both runs have counts once.
        differing: Number that differ beyond tolerance or stand in one run only, by topic.
        missing: Number that only the first run has, by topic.
        surplus: Number that only the second run has, by topic.
        moved: Number that would have to move within their step, so that both runs have the same order.
        tolerated: Number of floats that differ within tolerance.
        fields: How often each field differs, by topic and path; indices are written `[]`.
        divergences: The first divergence; with `keep_all` all of them, in order.
    """

    def __init__(self, tolerance: Tolerance, keep_all: bool = False) -> None:
        """Start an empty comparison."""
        self._tolerance, self._keep_all = tolerance, keep_all
        self.compared: Counter[str] = Counter()
        self.differing: Counter[str] = Counter()
        self.missing: Counter[str] = Counter()
        self.surplus: Counter[str] = Counter()
        self.moved = 0
        self.tolerated = 0
        self.fields: Counter[str] = Counter()
        self.divergences: list[Divergence] = []

    @property
    def identical(self) -> bool:
        """Whether the runs agree in every message."""
        return not self.divergences

    def in_words(self) -> str:
        """Return the number of messages compared, and the number of differences of each kind."""
        missing, surplus = self.missing.total(), self.surplus.total()
        found = {
            "differ": self.differing.total() - missing - surplus,
            "missing": missing,
            "too many": surplus,
            "in another order": self.moved,
        }
        said = [f"{count} {how}" for how, count in found.items() if count]
        return f"{self.compared.total()} messages: {', '.join(said) or 'IDENTICAL'}"

    def by_frequency(self) -> list[tuple[str, int]]:
        """Return the fields that differ, the most frequent first; equally frequent ones by name."""
        return sorted(self.fields.items(), key=lambda counted: (-counted[1], counted[0]))

    def add(self, step: int, expected: Sequence[Recorded], got: Sequence[Recorded]) -> bool:
        """Compare the messages of one step; return whether they agree."""
        one, other = (Counter(message.topic for message in side) for side in (expected, got))
        self.compared += one | other
        if [(m.topic, m.data, m.tick) for m in expected] == [(m.topic, m.data, m.tick) for m in got]:
            return True
        before = len(self.divergences)
        diverged = next(self._parting(step, expected, got), None)
        if diverged is None:
            return True
        self._count(expected, got)
        if self._keep_all or before == 0:
            self.divergences.append(diverged)
        return False

    def _parting(self, step: int, expected: Sequence[Recorded], got: Sequence[Recorded]) -> Iterator[Divergence]:
        """Yield the divergences of two lists of messages in order; the first is the cause of the others."""
        for a, b in zip_longest(expected, got):
            if a is None or b is None:
                shorter = Change("", ABSENT if a is None else a.topic, ABSENT if b is None else b.topic)
                yield Divergence(step, (a or b).topic, "length", (shorter,))
                return
            if a.topic != b.topic:
                yield Divergence(step, a.topic, "order", (Change("", a.topic, b.topic),))
                return
            if changes := self._changes(a, b):
                yield Divergence(step, a.topic, "value", changes)

    def _changes(self, a: Recorded, b: Recorded) -> tuple[Change, ...]:
        """Return the fields of two messages of one topic that differ beyond tolerance."""
        if a.data == b.data and a.tick == b.tick:
            return ()
        found = [] if a.tick == b.tick else [Change(".tick", a.tick, b.tick)]
        for change in _walk(fields_of(a), fields_of(b), ""):
            field = a.topic + change.path
            if field in self._tolerance.ignored:
                continue
            if _floats(change) and self._tolerance.allows(field, change.expected, change.got):  # type: ignore[arg-type]
                self.tolerated += 1
            else:
                found.append(change)
        if not found and self._tolerance.is_exact:  # equal values, encoded differently
            found.append(_in_bytes(a.data, b.data))
        return tuple(found)

    def _count(self, expected: Sequence[Recorded], got: Sequence[Recorded]) -> None:
        """Count the fields that differ; the n-th message of a topic is compared with the n-th."""
        tolerated = self.tolerated
        self.moved += _moved(expected, got)
        for topic in dict.fromkeys(m.topic for m in (*expected, *got)):
            one, other = ([m for m in side if m.topic == topic] for side in (expected, got))
            for a, b in zip_longest(one, other):
                if a is None or b is None:
                    self.fields[f"{topic} {'missing' if b is None else 'too many'}"] += 1
                    (self.missing if b is None else self.surplus)[topic] += 1
                    self.differing[topic] += 1
                elif changes := self._changes(a, b):
                    self.differing[topic] += 1
                    self.fields.update({f"{topic}{_general(change.path)}" for change in changes})
        self.tolerated = tolerated


def compare(
    expected: Trace,
    got: Trace,
    tolerance: Tolerance = EXACT,
    keep_all: bool = False,
    topics: Collection[str] = NOT_TIMED,
) -> Comparison:
    """Compare two recorded runs step by step.

    Args:
        expected: The first run.
        got: The second.
        tolerance: How far floats may lie apart; by default every byte counts.
        keep_all: Whether every divergence is kept; by default only the first is.
        topics: The topics to compare; by default all but wall times.

    Raises:
        TraceError: If a trace cannot be read.
    """
    return compare_steps(steps_of(expected, topics), steps_of(got, topics), tolerance, keep_all)


def steps_of(trace: Trace, topics: Collection[str]) -> Iterator[list[Recorded]]:
    """Yield the messages of some topics: those before the first decision, then those of each step."""
    for group in by_step(trace.messages(*topics, "/belief")):
        yield [message for message in group if message.topic in topics]


def compare_steps(
    expected: Iterable[Sequence[Recorded]],
    got: Iterable[Sequence[Recorded]],
    tolerance: Tolerance,
    keep_all: bool = False,
) -> Comparison:
    """Compare two runs, each given step by step as `by_step` yields them."""
    comparison = Comparison(tolerance, keep_all)
    for number, (a, b) in enumerate(zip_longest(expected, got, fillvalue=())):
        comparison.add(number - 1, a, b)
    return comparison


def by_step(messages: Iterable[Recorded]) -> Iterator[list[Recorded]]:
    """Yield the messages before the first decision, then those of each step; every belief begins a step."""
    group: list[Recorded] = []
    for message in messages:
        if message.topic == "/belief":
            yield group
            group = []
        group.append(message)
    yield group


def fields_of(message: Recorded) -> Any:
    """Return the content of a message in plain dictionaries, lists and values.

    Raises:
        TraceError: If the bytes are not a message of the topic's type.
    """
    if message.topic in JSON_TOPICS:
        try:
            return json.loads(message.data)
        except RecursionError as error:
            raise TraceError(f"{message.path}: {message.topic}: its text is nested too deeply to be read") from error
        except ValueError:
            return {"bytes": base64.b64encode(message.data).decode()}
    from google.protobuf.json_format import MessageToDict

    return MessageToDict(decode(message.topic, message.data), preserving_proto_field_name=True)


def _moved(expected: Sequence[Recorded], got: Sequence[Recorded]) -> int:
    """Return how many common messages stand outside the longest common order."""
    places = {numbered: place for place, numbered in enumerate(_numbered(got))}
    order = [places[numbered] for numbered in _numbered(expected) if numbered in places]
    ends: list[int] = []  # last value of the best rising sequence of each length: the longest one need not be moved
    for place in order:
        at = bisect_left(ends, place)
        ends[at : at + 1] = [place]
    return len(order) - len(ends)


def _numbered(messages: Sequence[Recorded]) -> Iterator[tuple[str, int]]:
    """Yield the topic of each message and the number of earlier messages of that topic."""
    before: Counter[str] = Counter()
    for message in messages:
        yield message.topic, before[message.topic]
        before[message.topic] += 1


def _walk(a: Any, b: Any, path: str) -> Iterator[Change]:
    """Yield every value that is not exactly equal."""
    if isinstance(a, dict) and isinstance(b, dict):
        for key in sorted(a.keys() | b.keys()):
            yield from _walk(a.get(key, ABSENT), b.get(key, ABSENT), f"{path}.{key}")
    elif isinstance(a, list) and isinstance(b, list):
        for i, (x, y) in enumerate(zip_longest(a, b, fillvalue=ABSENT)):
            yield from _walk(x, y, f"{path}[{i}]")
    elif type(a) is not type(b) or repr(a) != repr(b):
        yield Change(path, a, b)


def _in_bytes(a: bytes, b: bytes) -> Change:
    """Return the first difference between the bytes of two messages."""
    same = next(i for i, (x, y) in enumerate(zip_longest(a, b)) if x != y)
    expected, got = (data[same : same + SHOWN].decode(errors="backslashreplace") for data in (a, b))
    return Change(".bytes", expected, got)


def _number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _floats(change: Change) -> bool:
    """Return whether both values are numbers and at least one is a float."""
    return _number(change.expected) and _number(change.got) and float in (type(change.expected), type(change.got))


def _general(path: str) -> str:
    return re.sub(r"\[\d+\]", "[]", path)


def _short(value: object) -> str:
    text = json.dumps(value, ensure_ascii=False) if value != ABSENT else ABSENT
    return text if len(text) <= SHOWN else f"{text[: SHOWN - 3]}..."

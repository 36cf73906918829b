"""Rule files of others are read and asked in a child: what is too much for it is one message, and nothing else is."""

import gc
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from kit.places import ROOT
from typer.testing import CliRunner

from skolem.reasoner.planning.proofs import Derivation
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import Rulebook, rule_files
from skolem.reasoner.terms import Term, parse_term
from skolem.tools.loop import apart
from skolem.tools.run.command import app as run
from skolem.traces import Trace
from skolem.traces.errors import InputError, RuleError
from skolem.traces.messages import RunEnd

USED = " cost(S, x, 1) :- step(S), a(_, _)."
GROWING: dict[str, Callable[[int], str]] = {  # what is derived without end, or nearly so, by kind
    "join": lambda n: f"n(1..{n}). a(X, Y) :- n(X), n(Y), n(Z)." + USED,
    "join without a result": lambda n: f"n(1..{n}). a(X, Y) :- n(X), n(Y), n(Z), X + Y + Z < 0." + USED,
    "pools": lambda n: f"a({', '.join(['(' + ';'.join(map(str, range(n % 97))) + ')'] * 9)}). #show a/9.",
    "intervals": lambda n: f"a(1..{n}, 1..{n})." + USED,
    "terms in terms": lambda _: "a(z, z). a(f(X), Y) :- a(X, Y)." + USED,
    "pairs of pairs": lambda n: f"d(0, z). d(N + 1, (X, X)) :- d(N, X), N < {n % 500}. weight(X, 1, any) :- d(_, X).",
    "numbers": lambda _: "a(0, 0). a(N + 1, N) :- a(N, _)." + USED,
}


def own(folder: Path, text: str) -> Path:
    path = folder / "own.lp"
    path.write_text(text, encoding="utf-8")
    return path


def read(folder: Path, text: str) -> Rulebook:
    return apart.rulebook_of(rule_files([own(folder, text)])[0])


@pytest.fixture
def tight(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have the limits reached soon."""
    monkeypatch.setattr(apart, "SECONDS", 1)
    monkeypatch.setattr(apart, "BYTES", 60 << 20)


@pytest.mark.usefixtures("tight")
@pytest.mark.parametrize("size", [4321, 9999])
@pytest.mark.parametrize("kind", GROWING)
def test_what_grows_without_end_is_one_message_that_names_the_file(tmp_path: Path, kind: str, size: int) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, GROWING[kind](size))
    (fault,) = caught.value.faults
    assert fault.file == str(tmp_path / "own.lp")
    assert "this file takes more than" in fault.message or "nested too deeply" in fault.message


@pytest.mark.parametrize("depth", [101, 500, 20_000])
@pytest.mark.parametrize("around", [("f(", ")"), ("-", ""), ("1+", ""), ("(", ",)"), ("|", "|"), ("1**(", ")")])
def test_a_term_that_is_too_deep_is_refused_in_its_line(tmp_path: Path, around: tuple[str, str], depth: int) -> None:
    begin, end = around
    with pytest.raises(InputError) as caught:
        read(tmp_path, f"% first\nweight({begin * depth}1{end * depth}, 1, any).")
    assert {fault.line for fault in caught.value.faults} == {2}
    assert "more than 100 brackets and operators around one term" in caught.value.faults[0].message


@pytest.mark.parametrize("digits", [11, 35, 5_000])
@pytest.mark.parametrize("sign", ["", "-", "0x"])
def test_a_number_of_many_digits_is_refused_in_its_place(tmp_path: Path, sign: str, digits: int) -> None:
    with pytest.raises(InputError, match="does not fit 32 bits"):
        read(tmp_path, f"weight(airy, {sign}{'9' * digits}, any).")


@pytest.mark.parametrize("power", ["(999999999**64)**64", "((99**64)**64)**64", "9**9**9**9"])
def test_powers_of_powers_are_not_computed(tmp_path: Path, power: str) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, f"cost(S, x, {power}) :- step(S).")
    assert caught.value.faults[0].line == 1


class Silent:
    """Answers every query with nothing."""

    def __getattr__(self, name: str) -> Callable[..., list[Term]]:
        return lambda *_: []


class OfOne:
    """Knows one object."""

    def rigid(self, obj: Term) -> Term:
        return int(obj == "o1")

    def __getattr__(self, name: str) -> Callable[..., list[Term]]:
        return lambda *_: []


GOAL = parse_term("goal(b(on(o1,table1),105361))")
OWN = "rejected(S, whim) :- step(S), S = place(O, _, _), @rigid(O) = 1."


def test_a_child_answers_as_this_process_would(tmp_path: Path) -> None:
    here, there = Rulebook.load(Queries, [own(tmp_path, OWN)]), read(tmp_path, OWN)
    assert there.solve([GOAL], OfOne()) == here.solve([GOAL], OfOne())
    assert there.solve([GOAL], OfOne()).atoms["rejected"]
    atoms = Derivation(there, [GOAL], OfOne()).atoms("rejected", 2)
    assert atoms == Derivation(here, [GOAL], OfOne()).atoms("rejected", 2)
    assert atoms


def test_a_query_that_fails_here_is_told_by_the_child_and_the_child_goes_on(tmp_path: Path) -> None:
    class Broken(OfOne):
        def rigid(self, obj: Term) -> Term:
            raise KeyError(obj)

    book = read(tmp_path, OWN)
    with pytest.raises(RuleError, match=r"query @rigid\(o1\) failed: KeyError: 'o1'"):
        book.solve([GOAL], Broken())
    assert book.solve([GOAL], OfOne()).atoms["rejected"]


@pytest.mark.usefixtures("tight")
@pytest.mark.parametrize("size", [3_000])
@pytest.mark.parametrize(
    "rule",
    [
        "rejected(S, x) :- step(S), n(X), n(Y), n(Z), X + Y + Z < 0.",
        "rejected(S, X) :- step(S), d(N, X), N > 900.",
        "rejected(S, (X, Y)) :- step(S), n(X), n(Y).",
    ],
    ids=["slow", "deep", "large"],
)
def test_rules_that_are_too_much_only_once_there_is_a_goal_are_refused_then(
    tmp_path: Path, rule: str, size: int
) -> None:
    book = read(
        tmp_path,
        f"n(1..{size}). d(0, z). d(N + 1, f(X)) :- d(N, X), N < {size // 3}. {rule} unused(N) :- n(N). "
        "unused(N) :- d(N, _). rejected(S, y) :- step(S), not unused(1).",
    )
    with pytest.raises((InputError, RuleError)), book.answerable():
        book.solve([GOAL], Silent())


def test_rules_that_ship_are_read_without_a_child(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "fork", lambda: pytest.fail("forked"))
    assert apart.rulebook_of(rule_files()[0]).vocabulary.meanings


def children() -> set[str]:
    """Return the process ids of the children of this process."""
    return set(Path(f"/proc/self/task/{os.getpid()}/children").read_text(encoding="ascii").split())


def test_no_child_is_left_behind(tmp_path: Path) -> None:
    before = children()
    book = read(tmp_path, OWN)
    assert book.solve([GOAL], OfOne()).atoms
    (child,) = children() - before
    del book
    gc.collect()
    assert child not in children()


def scenario_with(folder: Path, rules: str) -> Path:
    own(folder, rules)
    text = (ROOT / "scenarios" / "sim1_green.yaml").read_text(encoding="utf-8")
    path = folder / "own.yaml"
    path.write_text(text.replace("\nseed:", "\nrules: [own.lp]\nseed:", 1), encoding="utf-8")
    return path


@pytest.mark.usefixtures("tight")
def test_the_limit_ends_a_run_with_status_2_and_becomes_no_decision(tmp_path: Path) -> None:
    scenario = scenario_with(tmp_path, "n(1..3000). cost(S, x, 1) :- step(S), n(X), n(Y), n(Z), X + Y + Z < 0.")
    out = tmp_path / "a.mcap"
    result = CliRunner().invoke(run, [str(scenario), "--world", "symbolic", "-q", "-o", str(out)])
    assert isinstance(result.exception, InputError)
    assert "own.lp: this file takes more than" in str(result.exception)
    trace = Trace(out)
    assert not list(trace.messages("/decision"))
    assert [end.status for end in trace.of(RunEnd)] == ["error"]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_who_reads_endless_rules_ends_at_once_when_asked_to(tmp_path: Path, number: signal.Signals) -> None:
    path = own(tmp_path, GROWING["join without a result"](9999))
    command = [sys.executable, "-c", "import sys; from skolem.tools.cli import main; sys.exit(main())"]
    with subprocess.Popen([*command, "rules", "check", str(path)], start_new_session=True) as process:
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
        while not children.read_text():
            assert process.poll() is None
            time.sleep(0.02)
        begun = time.monotonic()
        process.send_signal(number)
        assert process.wait(10) == 130
        assert time.monotonic() - begun < 2

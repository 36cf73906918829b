"""Rules that `rules check` passes run, or are refused with file and line: no internal error after some steps."""

import itertools
from pathlib import Path

import pytest
from kit.places import ROOT

from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.validate import query_arities
from skolem.tools.loop.session import run
from skolem.tools.loop.setup import prepare
from skolem.traces.errors import InputError

KINDS = ("5", "-1", "foo", "f(x)", "(green,)", "any", "O", "S", "2147483647")
LOOK = "step(S), S = look(O)"
ODD = (
    "cost(S, x, N) :- step(S), N = (any; 1).",
    "cost(S, x, @rigid(O) - 5) :- step(S), S = look(O).",
    "cost(S, x, N) :- step(S), N = #max { X : goal(f(X)) }.",
    "cost(S, x, N) :- step(S), N = 1 / @rigid(S).",
    f"result(S, bn(pose(O), any, sd(0, 0, 0), any, any)) :- {LOOK}.",
    f"precond(S, bn(pose(O), v(1), sd(1, 2, 3, 4, 5, 6, 7), tol(0), 0), 1) :- {LOOK}.",
    f"precond(S, bn(weight(O), foo, f(1, 2), 3, bar), 1) :- {LOOK}.",
    f"precond(S, b(prop(W, O), 1), 1) :- {LOOK}, W = O.",
    f"executes(S, pick(O, O)) :- {LOOK}.",
    f"executes(S, move(5)) :- {LOOK}.",
    "step(5) :- goal(_).",
)


def outcome(folder: Path, rule: str) -> str:
    """Return what became of a run with a rule: `ran`, or the first line of the fault."""
    (folder / "own.lp").write_text(rule, encoding="utf-8")
    text = (ROOT / "scenarios" / "sim1_green.yaml").read_text(encoding="utf-8")
    path = folder / "own.yaml"
    path.write_text(text.replace("\nseed:", "\nrules: [own.lp]\nseed:", 1), encoding="utf-8")
    try:
        run(prepare(path, ["limits.steps=1", "limits.expansions=100"], world="symbolic"), folder / "a.mcap")
    except InputError as error:
        return "".join(f"{fault}\n" for fault in error.faults if fault.file == str(folder / "own.lp"))
    return "ran"


@pytest.mark.parametrize("query", sorted(name for name, n in query_arities(Queries).items() if n)[::4])
def test_a_query_with_the_wrong_kind_of_argument_is_a_fault_with_its_line(tmp_path: Path, query: str) -> None:
    n = query_arities(Queries)[query]
    picked = list(itertools.product(KINDS, repeat=n))[:: max(1, len(KINDS) ** n // 4)][:4]
    rules = [f"rejected(S, {i}) :- {LOOK}, R = @{query}({', '.join(c)}), R = 77." for i, c in enumerate(picked)]
    said = outcome(tmp_path, "\n".join(rules))
    assert said == "ran" or "own.lp:" in said


@pytest.mark.parametrize("rule", ODD)
def test_an_odd_rule_runs_or_is_refused_by_name(tmp_path: Path, rule: str) -> None:
    assert "own.lp" in (said := outcome(tmp_path, rule)) or said == "ran"


@pytest.mark.parametrize(
    ("rule", "place"),
    [
        ("cost(S, x, any) :- step(S).", "1:1: cost/3 ends in a whole number from 0, found any"),
        ("precond(S, krd(O), any) :- step(S), S = look(O).", "1:1: precond/3 ends in a whole number"),
        ("cost(S, x, #inf) :- step(S).", "1:12: #inf is no term of the rules"),
        ("weight(airy, #sup, any).", "1:14: #sup is no term of the rules"),
        (f"rejected(S, x) :- {LOOK}, @detected(5) = 7.", "1:1: 5 in @detected(5) is no anchor: expected a constant"),
        (f"rejected(S, x) :- {LOOK}, @favourable(green, O, z) = 7.", "1:1: z in @favourable(green,O,z) is no p"),
        (f"rejected(S, x) :- {LOOK}, @each(O) = 7, @each(z) = 8.", "1:1: z in @each(z) is no props: expected a tuple"),
        (f"cost(S, x, @distance(O) - 9999) :- {LOOK}.", "1:1: cost(look("),
        (f"rejected(S, x) :- {LOOK}, R = @blockers(O), R = 7.", "1:1: query @blockers("),
    ],
)
def test_the_place_is_named(tmp_path: Path, rule: str, place: str) -> None:
    assert f"own.lp:{place}" in outcome(tmp_path, rule)

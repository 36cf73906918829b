"""What is doubtful in rule files: each kind of complaint, none about the shipped rules, allowances with reasons."""

import re
from pathlib import Path

import pytest
from kit.minds import Region, TableBelief, TableGeometry, Thing

from skolem.reasoner.lint.fluent_kinds import ACTIVITIES, FLUENTS
from skolem.reasoner.lint.linting import CODES, NO_SUCH_CODE, findings
from skolem.reasoner.lint.wrong_rules import NOT_A_FLUENT, refuse_wrong
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.planning.situation import Situation
from skolem.reasoner.rulebook.book import Rulebook, rule_files
from skolem.reasoner.rulebook.examination import examine
from skolem.reasoner.terms import parse_term
from skolem.reasoner.worlds.evaluator import Interval
from skolem.traces.errors import InputError

PUSH = """step(push(O)) :- goal(b(on(O, S), _)), @rigid(S) = 1.
executes(S, look(O)) :- step(S), S = push(O).
result(S, b(on(O, T), P)) :- step(S), S = push(O), goal(b(on(O, T), P)).
precond(S, krd(O), 0) :- step(S), S = push(O).
"""


def complaints(tmp_path: Path, text: str) -> list[tuple[int, str, str]]:
    path = tmp_path / "own.lp"
    path.write_text(text, encoding="utf-8")
    found = findings(Rulebook.load(Queries, [path]))
    return [(f.fault.line, f.code, f.fault.message) for f in found if f.fault.file == str(path) and not f.allowed]


def test_the_shipped_rules_give_no_reason_to_complain_that_is_not_explained_in_them() -> None:
    found = findings(Rulebook.load(Queries))
    assert [finding for finding in found if not finding.allowed] == []
    assert {finding.code for finding in found} <= set(CODES)


@pytest.mark.parametrize(
    ("code", "said"), [("without_krdd", "did you mean without_krd?"), ("nonsense", "there are: unreachable, ")]
)
def test_an_allowance_of_nothing_is_complained_of(tmp_path: Path, code: str, said: str) -> None:
    ((line, found, message),) = complaints(tmp_path, f"{PUSH}% allow {code}: it is meant so\n{PUSH}")
    assert (line, found) == (5, NO_SUCH_CODE)
    assert said in message


def test_bytes_that_are_no_text_are_a_fault_of_the_file_and_no_obstacle_to_its_check(tmp_path: Path) -> None:
    path = tmp_path / "own.lp"
    path.write_bytes(b"% allow caf\xe9: x\nfoo(1).\n")
    sources, _ = rule_files([path])
    examined = examine(sources, Queries)
    assert [fault.message for fault in examined.faults if fault.file == str(path)] == ["not UTF-8: byte 11"]
    assert findings(examined) == []


def test_rules_that_fit_in_are_not_complained_of(tmp_path: Path) -> None:
    assert complaints(tmp_path, PUSH) == []


@pytest.mark.parametrize(
    ("text", "line", "code", "message"),
    [
        (PUSH + "precond(S, holdin(O), 0) :- step(S), S = push(O).", 5, NOT_A_FLUENT, "did you mean holding?"),
        (PUSH + "result(S, b(onn(O, O), 5)) :- step(S), S = push(O).", 5, NOT_A_FLUENT, "did you mean b(on)?"),
        (PUSH + "destroys(S, lose(O)) :- step(S), S = push(O).", 5, NOT_A_FLUENT, "did you mean loose?"),
        ("step(wipe(O)) :- goal(b(clean(O), _)).", 1, NOT_A_FLUENT, "b(clean) is not a fluent"),
        ("mutex(empty(same(h)), ful(same(h))).", 1, NOT_A_FLUENT, "ful is not a fluent"),
        (PUSH + "executes(S, shove(O)) :- step(S), S = push(O).", 5, NOT_A_FLUENT, "the robot cannot carry out Shove"),
        (PUSH + "executes(S, look(O, twice)) :- step(S), S = push(O).", 5, NOT_A_FLUENT, "there are: look(object), "),
        (PUSH + "precond(S, at(stare(O)), 1) :- step(S), S = push(O).", 5, NOT_A_FLUENT, "expected at(activity)"),
        (PUSH + "precond(S, empty(middle), 1) :- step(S), S = push(O).", 5, NOT_A_FLUENT, "hand is right, left"),
        (PUSH + "precond(S, krd(O), first) :- step(S), S = push(O).", 5, NOT_A_FLUENT, "found first"),
        (PUSH + "cost(S, effort, high) :- step(S), S = push(O).", 5, NOT_A_FLUENT, "a whole number from 0, found high"),
        (PUSH + "cost(S, effort, -3) :- step(S), S = push(_).", 5, NOT_A_FLUENT, "a whole number from 0, found -3"),
        (PUSH + "cost(S, effort, x + 1) :- step(S), S = push(_).\n#const x = -2.", 5, NOT_A_FLUENT, "found -1"),
        (PUSH + "cost(S, effort, x + 1) :- step(S), S = push(_).\n#const x = 2.", 0, "", ""),
        (
            PUSH + "precond(S, b(supposed(gren, O), 5), 0) :- step(S), S = push(O).",
            5,
            NOT_A_FLUENT,
            "did you mean green?",
        ),
        (PUSH + "precond(S, b(type(O, cann), 5), 0) :- step(S), S = push(O).", 5, NOT_A_FLUENT, "did you mean can?"),
        (
            PUSH + "precond(S, b(holds((red, lite), O), 5), 0) :- step(S), S = push(O).",
            5,
            NOT_A_FLUENT,
            "lite in b(holds",
        ),
        (PUSH + "precond(S, b(supposed(red, O), 5), 0) :- step(S), S = push(O).", 0, "", ""),
        (PUSH + "cost(S, effort, 5 - 2 ** 3) :- step(S), S = push(_).", 5, NOT_A_FLUENT, "found -3"),
        (PUSH + "cost(S, effort, -(7 / 2)) :- step(S), S = push(_).", 5, NOT_A_FLUENT, "found -3"),
        (PUSH + "cost(S, effort, -1..1) :- step(S), S = push(_).", 5, NOT_A_FLUENT, "found -1"),
        (PUSH + "pen(a, -3; b, 4). cost(S, effort, C) :- step(S), pen(_, C), C > 0.", 0, "", ""),
        (
            PUSH + "kind(soda; thing). precond(S, b(type(O, K), 5), 0) :- step(S), S = push(O), kind(K), type(K).",
            0,
            "",
            "",
        ),
        (PUSH + "cost(S, effort, @believed(gren, O)) :- step(S), S = push(O).", 5, NOT_A_FLUENT, "did you mean green?"),
        (PUSH + "cost(S, effort, 1) :- step(S), _ = @in_hand(middle).", 5, NOT_A_FLUENT, "there are: right, left"),
        ("measures(heavy, colour).", 1, NOT_A_FLUENT, "heavy is about the weight of an object"),
        (PUSH + "precond(S, b(exists_in(E, O), 5), 0) :- step(S), S = push(O), E = e1.", 5, "unreachable", "exists_in"),
        (PUSH + "result(S, b(supposed(K, O), 5)) :- step(S), S = push(O), type(K).", 0, "", ""),
        ("step(wipe(O)) :- goal(holding(O)).", 1, "without_result", "wipe has no result"),
        (PUSH + "precond(S, loose(O), 2) :- step(S), S = push(O).", 1, "level_gap", "of level 1"),
        (PUSH.replace("krd(O)", "loose(O)"), 2, "without_krd", "precond(S, krd(O), 0)"),
        ("measures(glossy, gloss).", 1, "unobservable", "no operator yields the gloss"),
        ("measures(glossy, colour).", 1, "unobservable", "state what it is"),
    ],
)
def test_each_doubtful_thing_is_complained_of_where_it_stands(
    tmp_path: Path, text: str, line: int, code: str, message: str
) -> None:
    found = [(at, kind) for at, kind, said in complaints(tmp_path, text) if message in said]
    assert (found == [] and not code) or (line, code) in found


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (PUSH + "precond(S, b(exists_in(E, O), 5), 0) :- step(S), S = push(O), E = e1.", "unreachable"),
        (PUSH + "result(S, held(both, O)) :- step(S), S = push(O).", "unused_result"),
        (PUSH.replace("krd(O)", "loose(O)"), "without_krd"),
        ("step(wipe(O)) :- goal(holding(O)).", "without_result"),
        (PUSH + "precond(S, loose(O), 2) :- step(S), S = push(O).", "level_gap"),
        ("measures(smelly, smell).", "unobservable"),
    ],
)
def test_each_complaint_names_a_remedy(tmp_path: Path, text: str, code: str) -> None:
    said = [message for _, kind, message in complaints(tmp_path, text) if kind == code]
    assert said
    assert all("; " in message or ": state " in message for message in said)


def test_what_would_stop_a_run_is_refused_in_the_words_of_the_complaint(tmp_path: Path) -> None:
    path = tmp_path / "own.lp"
    wrong = "precond(S, holdin(O), 0) :- step(S), S = push(O).\nexecutes(S, shove(O)) :- step(S), S = push(O)."
    path.write_text(PUSH + wrong, encoding="utf-8")
    rulebook = Rulebook.load(Queries, [path])
    with pytest.raises(InputError) as refusal:
        refuse_wrong(rulebook)
    assert [fault.line for fault in refusal.value.faults] == [5, 6]
    assert list(refusal.value.faults) == [f.fault for f in findings(rulebook) if f.code == NOT_A_FLUENT]


def test_what_is_doubtful_is_not_refused(tmp_path: Path) -> None:
    path = tmp_path / "own.lp"
    path.write_text(PUSH + "result(S, held(both, O)) :- step(S), S = push(O).", encoding="utf-8")
    refuse_wrong(Rulebook.load(Queries, [path]))


def test_a_result_that_nothing_needs_is_complained_of(tmp_path: Path) -> None:
    moved = "result(S, aside(O, look_region(R))) :- step(S), S = push(O), R = x."
    assert complaints(tmp_path, PUSH + moved) == []
    text = PUSH + "result(S, held(both, O)) :- step(S), S = push(O)."
    assert [(line, code) for line, code, _ in complaints(tmp_path, text)] == [(5, "unused_result")]


def test_a_complaint_is_allowed_with_a_reason_above_the_rule(tmp_path: Path) -> None:
    doubtful = "result(S, held(both, O)) :- step(S), S = push(O)."
    assert complaints(tmp_path, f"{PUSH}% allow unused_result: two hands come later\n{doubtful}") == []
    assert complaints(tmp_path, f"{PUSH}% allow unreachable: another code\n{doubtful}") != []
    assert complaints(tmp_path, f"{PUSH}% allow unused_result:\n{doubtful}") != []


def test_the_belief_and_the_geometry_answer_every_fluent_of_the_table() -> None:
    names = {"expression": "e1", "properties": "(soda,heavy)", "word": "soda", "region": "shelf", "hand": "right"}
    belief = TableBelief({"object": Thing({"soda": 1.0}, hand="right")}, {"shelf": Region("object")})
    meanings = Rulebook.load(Queries).vocabulary.meanings
    situation = Situation(
        belief, TableGeometry(), lambda *_: 0.5, lambda *_: 0.5, meanings, world=lambda *_: Interval(0.5, 0.5)
    )
    for text in FLUENTS:
        for activity in ACTIVITIES:
            filled = text.replace("activity", activity)
            for sort, name in names.items():
                filled = re.sub(rf"\b{sort}\b", name, filled)
            filled = filled.replace(",any)", ",100)") if filled.startswith("b(") else filled
            filled = filled.replace("place(object,object,any)", "place(object,object,nothing)")
            assert situation.holds(parse_term(filled)) in (True, False)

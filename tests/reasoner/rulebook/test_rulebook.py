"""The rule files as one program: complete, silent, with one answer set, and small however much is known."""

import hashlib
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path

import pytest

from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.asking import Asked
from skolem.reasoner.rulebook.book import RULE_FILES, Rulebook
from skolem.reasoner.terms import Term, compound, parse_term
from skolem.traces.errors import InputError, InternalError


class Silent:
    """Answers every query with nothing."""

    def __getattr__(self, name: str) -> Callable[..., list[Term]]:
        return lambda *_: []


@pytest.fixture(scope="module")
def shipped() -> Rulebook:
    return Rulebook.load(Queries)


def own_rules(tmp_path: Path, text: str, queries_type: type = Queries) -> Rulebook:
    path = tmp_path / "own.lp"
    path.write_text(text, encoding="utf-8")
    return Rulebook.load(queries_type, [path])


def test_the_table_of_contents_names_every_rule_file() -> None:
    shipped = {path.name for path in files("skolem.rules").iterdir() if path.name.endswith(".lp")}
    assert {f"{name}.lp" for name in RULE_FILES} == shipped


def test_shipped_rules_pass_validation_and_solve_silently(shipped: Rulebook) -> None:
    assert shipped.warnings == ()
    facts = ["goal(b(den(e1,o1),105361))", "goal(b(on(o1,table1),105361))", "goal(holding(o1))", "open(var(o))"]
    assert shipped.solve(map(parse_term, facts), Silent()).ground_atoms > 0


def test_files_and_their_hashes_are_at_hand_for_a_trace(shipped: Rulebook, tmp_path: Path) -> None:
    book = own_rules(tmp_path, "weight(airy, 0, 1).")
    assert list(book.files) == [*(f"{name}.lp" for name in RULE_FILES), "own.lp"]
    assert book.sha256["own.lp"] == hashlib.sha256(b"weight(airy, 0, 1).").hexdigest()
    assert {name: digest for name, digest in book.sha256.items() if name != "own.lp"} == shipped.sha256


def test_answers_are_grouped_by_predicate_and_sorted(tmp_path: Path) -> None:
    book = own_rules(tmp_path, "far(O) :- goal(krd(O)). far(z; y). done :- far(z). #show far/1. #show done/0.")
    answer = book.solve([parse_term("goal(krd(a))")], None, ["own"])
    assert answer.atoms["far"] == [("a",), ("y",), ("z",)]
    assert answer.atoms["done"] == [()]


def test_an_unnamed_variable_means_any_value_also_under_not_and_inside_a_count(tmp_path: Path) -> None:
    rules = (
        "h(1, a; 2, b; 2, c). g(2, d). "
        "some(O) :- goal(krd(O)), h(_, _). none(O) :- goal(krd(O)), not h(_, O). "
        "n(O, N) :- goal(krd(O)), N = #count { X : h(X, _), not g(X, _) }. "
        "w(O, N) :- goal(krd(O)), N = #count { X, Y : h(X, Y), not g(_, Y) }. "
        "#show some/1. #show none/1. #show n/2. #show w/2."
    )
    book = own_rules(tmp_path, rules)
    answers = book.solve_each([(parse_term("goal(krd(a))"),), (parse_term("goal(krd(z))"),)], Asked(None), ["own"])
    assert answers.atoms[0] == {"some": [("a",)], "n": [("a", 1)], "w": [("a", 3)]}
    assert answers.atoms[1] == {"some": [("z",)], "none": [("z",)], "n": [("z", 1)], "w": [("z", 3)]}


def test_a_count_may_be_all_that_a_rule_asks(tmp_path: Path) -> None:
    book = own_rules(tmp_path, "n(C) :- C = #count { X : m(X) }. m(X) :- goal(krd(X)). #show n/1.")
    questions = [tuple(parse_term(f"goal(krd({name}))") for name in names) for names in ("a", "ab")]
    assert [atoms["n"] for atoms in book.solve_each(questions, Asked(None), ["own"]).atoms] == [[(1,)], [(2,)]]


def test_pools_may_stand_anywhere(tmp_path: Path) -> None:
    rules = (
        "m(O, f(O); a, O) :- goal(krd(O)). n(X) :- m(X, (O; f(O))), goal(krd(O)), not m(X; b, X). "
        "#defined m/1. #show both(X) : n(X; X). #show m/2. #show (one(X); two(X)) : m(X, _)."
    )
    atoms = own_rules(tmp_path, rules).solve([parse_term("goal(krd(z))")], None, ["own"]).atoms
    shown = {f"{name}({','.join(map(str, args))})" for name, found in atoms.items() for args in found}
    one_and_two = {f"{name}({x})" for name in ("one", "two") for x in ("a", "z")}
    assert shown == {"m(z,f(z))", "m(a,z)", "both(a)", "both(z)", *one_and_two}


def test_classical_negation_of_what_is_declared_holds_of_nothing(tmp_path: Path) -> None:
    book = own_rules(tmp_path, "#defined -bad/1. m(X) :- goal(krd(X)), not -bad(X). #show m/1.")
    assert book.solve([parse_term("goal(krd(a))")], None, ["own"]).atoms == {"m": [("a",)]}


def test_rules_ask_queries_in_terms(tmp_path: Path) -> None:
    class Scales:
        def mass(self, anchor: Term) -> Term:
            return len(str(anchor))

        def heavier(self, anchor: Term, grams: int) -> list[Term]:
            return [compound("", anchor, grams + i) for i in range(2)]

    rules = "m(O, N) :- goal(krd(O)), N = @mass(O). h(X) :- goal(krd(O)), X = @heavier(O, 3). #show m/2. #show h/1."
    path = tmp_path / "scales.lp"
    path.write_text(rules, encoding="utf-8")

    class Both(Queries, Scales):
        pass

    book = Rulebook.load(Both, [path])
    answer = book.solve([parse_term("goal(krd(o2))")], Scales(), ["scales"])
    assert answer.atoms == {"m": [("o2", 2)], "h": [(parse_term("(o2,3)"),), (parse_term("(o2,4)"),)]}


def test_a_query_that_fails_is_named_with_its_arguments(tmp_path: Path) -> None:
    class Broken(Queries):
        def mass(self, anchor: Term) -> Term:
            raise KeyError(anchor)

    book = own_rules(tmp_path, "m(N) :- goal(krd(O)), N = @mass(O). #show m/1.", Broken)
    with pytest.raises(InternalError, match=r"query @mass\(o2\) failed: KeyError: 'o2'"):
        book.solve([parse_term("goal(krd(o2))")], Broken.__new__(Broken), ["own"])


def test_what_clingo_remarks_while_solving_is_a_fault_of_own_rules_with_its_place(tmp_path: Path) -> None:
    book = own_rules(tmp_path, "m(N + 1) :- goal(krd(N)). #show m/1.")
    with pytest.raises(InputError, match=r"own\.lp:1:3: operation undefined: \(N\+1\)"):
        book.solve([parse_term("goal(krd(heavy))")], None, ["own"])


def test_an_unknown_rule_file_is_an_error_that_lists_the_known_ones(shipped: Rulebook) -> None:
    with pytest.raises(InternalError, match="no rule file 'denot'; there are: vocabulary, denote"):
        shipped.solve([], None, ["denot"])


@pytest.mark.parametrize(
    ("name", "message"),
    [("missing.lp", "cannot be read: No such file"), ("vocabulary.lp", "there is another rule file")],
)
def test_own_files_that_cannot_be_told_apart_or_read_are_refused(tmp_path: Path, name: str, message: str) -> None:
    (tmp_path / "vocabulary.lp").write_text("", encoding="utf-8")
    with pytest.raises(InputError) as caught:
        Rulebook.load(Queries, [tmp_path / name])
    (fault,) = caught.value.faults
    assert fault.file == str(tmp_path / name)
    assert fault.message.startswith(message)


def test_an_own_file_must_be_a_rule_file(tmp_path: Path) -> None:
    (tmp_path / "own.txt").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match=r"own\.txt: expected a rule file whose name ends in \.lp"):
        Rulebook.load(Queries, [tmp_path / "own.txt"])


def test_a_question_is_asked_once_whoever_asks_in_terms_or_in_symbols() -> None:
    """A child process asks in terms; a second question would be one more than the trace has recorded."""
    asked: list[str] = []

    class Source:
        def weighs(self, anchor: str) -> int:
            asked.append(anchor)
            return len(asked)

    source = Asked.source(Asked(Source()))
    answers = [getattr(source, "weighs")(anchor) for anchor in ("a", "a", "b", "a")]  # noqa: B009 - as a child asks
    assert answers == [1, 1, 2, 1]
    assert asked == ["a", "b"]

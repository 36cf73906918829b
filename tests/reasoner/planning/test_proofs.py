"""Derivations are the rules' own: every atom with the rule that gives it, queries with their answers."""

from collections.abc import Callable
from pathlib import Path

import pytest

from skolem.reasoner.planning.proofs import Derivation, Proof, rules_used
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import Rulebook
from skolem.reasoner.terms import Term, compound, parse_term

OWN = """far(O) :- goal(holding(O)), @distance(O) = D, D > 10.
beside(O, P) :- shelf(O, P), not far(O), shelf(_, P).
shelf(a, b). shelf(b, c).
farther(O) :- far(O).
farther(O) :- farther(O), goal(_).
#show farther/1.
#show beside/2.
#show shelf/2.
"""


class Ruler:
    """Knows how far things are, that they are anchors, and nothing else."""

    def distance(self, anchor: str) -> Term:
        return 100 if anchor == "o1" else 1

    def rigid(self, obj: Term) -> Term:
        return int(isinstance(obj, str))

    def __getattr__(self, name: str) -> Callable[..., list[Term]]:
        return lambda *_: []


def derivation(tmp_path: Path, fluent: str) -> Derivation:
    path = tmp_path / "own.lp"
    path.write_text(OWN, encoding="utf-8")
    return Derivation(Rulebook.load(Queries, [path]), [compound("goal", parse_term(fluent))], Ruler())


def test_an_atom_is_traced_to_what_was_given_and_asked(tmp_path: Path) -> None:
    proof = derivation(tmp_path, "holding(o1)").proof(parse_term("farther(o1)"))
    assert (proof.atom, proof.place) == (parse_term("farther(o1)"), "own.lp:4")
    (far,) = proof.premises
    assert (far.atom, far.place) == (parse_term("far(o1)"), "own.lp:1")
    assert far.premises == (
        Proof(parse_term("goal(holding(o1))")),
        Proof(compound("=", parse_term("distance(o1)"), 100)),
    )
    assert list(rules_used(proof)) == ["own.lp:4", "own.lp:1"]


def test_what_does_not_follow_has_no_derivation(tmp_path: Path) -> None:
    found = derivation(tmp_path, "holding(o2)")
    assert found.proof(parse_term("far(o2)")) == Proof(parse_term("far(o2)"))
    assert found.atoms("farther", 1) == []


def test_negation_and_facts_are_no_obstacle(tmp_path: Path) -> None:
    found = derivation(tmp_path, "holding(o1)")
    assert [str(atom) for atom in found.atoms("beside", 2)] == ["beside(a,b)", "beside(b,c)"]
    proof = found.proof(parse_term("beside(a,b)"))
    assert [premise.place for premise in proof.premises] == ["own.lp:3", "own.lp:3"]


@pytest.mark.parametrize("fluent", ["holding(o1)", "at(look(o1))", "b(contents(reg),100)"])
def test_every_step_that_the_rules_offer_has_a_derivation(fluent: str, tmp_path: Path) -> None:
    found = derivation(tmp_path, fluent)
    offered = Rulebook.load(Queries).solve([compound("goal", parse_term(fluent))], Ruler())
    for (step,) in offered.atoms.get("candidate", []):
        assert found.proof(compound("step", step)).file

"""Goals to which an evaluation or older rules give no value are told of; goals of the paper never are."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from kit.descriptions import goals, wide_goals
from kit.papers import shipped
from kit.places import RULES

from skolem.reasoner.language.expressions import Goal
from skolem.reasoner.language.parser import parse_goal
from skolem.reasoner.meaning.evaluations import unvalued
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import Rulebook
from skolem.traces.messages import Evaluation

NAMES = ("can1", "table1")


def told(text: str, evaluation: Evaluation) -> list[str]:
    goal = parse_goal(text, shipped().vocabulary.words(), NAMES)
    return unvalued(replace(goal, evaluation=evaluation), shipped())


@pytest.mark.parametrize(
    ("goal", "part"),
    [
        ("exists o. B(Den(the x. Can(x), o), 0.9)", "the x. Can(x)"),
        ("exists o. B(Den(heaviest x. Can(x), o), 0.9)", "heaviest x. Can(x)"),
        ("exists o. B(Den(lambda x. not Can(x), o), 0.9)", "lambda x. not Can(x)"),
        ("exists o. B(Den(lambda x. Can(x) & x != can1, o), 0.9)", "lambda x. Can(x) & x != can1"),
        ("exists o. B(Den(lambda x. Was(On(x, table1)), o), 0.9)", "lambda x. Was(On(x, table1))"),
        ("B(exactly 2 x. Can(x), 0.9)", "exactly 2 x. Can(x)"),
        ("B(every x. Can(x) -> On(x, table1), 0.9)", "every x. Can(x) -> On(x, table1)"),
        ("B(Can(can1) & On(can1, table1), 0.9)", "Can(can1) & On(can1, table1)"),
    ],
)
def test_the_papers_product_has_no_value_for_what_is_beyond_the_paper(goal: str, part: str) -> None:
    (fault,) = told(goal, "independent")
    assert fault.startswith(f"{part}: belief.evaluation: independent has no value for it")
    assert fault.endswith("use worlds")
    assert told(goal, "worlds") == []


@given(goals())
def test_goals_of_the_paper_can_be_evaluated_in_either_way(goal: Goal) -> None:
    assert unvalued(replace(goal, evaluation="independent"), shipped()) == []


@given(wide_goals())
def test_every_goal_can_be_evaluated_by_possible_worlds(goal: Goal) -> None:
    assert unvalued(goal, shipped()) == []


def test_rules_without_the_axioms_of_the_wider_language_are_told_of(tmp_path: Path) -> None:
    for path in RULES.glob("*.lp"):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    denote = tmp_path / "denote.lp"
    text = denote.read_text().replace("#show whole/2.\n", "").replace("whole(_, E)", "lambda(_, _, E)")
    text = re.sub(r"^whole\(.*(?=^expr\(E\))", "", text, count=1, flags=re.MULTILINE | re.DOTALL)
    denote.write_text(text.replace("lambda(D, X, _), whole(D, E)", "lambda(D, X, E)"))
    book = Rulebook.load(Queries, folder=tmp_path)
    for text, faults in (("the x. Can(x)", 1), ("lambda x. Can(x)", 0)):
        goal = parse_goal(f"exists o. B(Den({text}, o), 0.9)", book.vocabulary.words(), NAMES)
        assert len(found := unvalued(goal, book)) == faults
        assert all("these rules are from before" in fault for fault in found)

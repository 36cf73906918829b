"""G2: the rules of denotation augment a planner that does without them."""

from dataclasses import replace
from pathlib import Path

import pytest
from kit.papers import GREEN_TO_TABLE1, HUES, shipped, three_sodas
from kit.plays import Play

from skolem.reasoner.rulebook.book import RULE_FILES, Rulebook

DENOTATION = ("denote.lp", "infer.lp", "find.lp")
OTHERS = tuple(f"{name}.lp" for name in RULE_FILES if f"{name}.lp" not in DENOTATION)


@pytest.fixture(scope="module")
def without() -> Rulebook:
    """The rules but for those of denotation."""
    return replace(shipped(), files={n: text for n, text in shipped().files.items() if n not in DENOTATION})


def test_goals_about_named_objects_are_achieved_without_the_rules_of_denotation(without: Rulebook) -> None:
    """ "Inference rules and planning operators that can be used to augment an existing system"."""
    assert len(without.files) == len(OTHERS)
    play = Play(without, "B(On(sodaE, table2), 0.9)", three_sodas())
    operators = play.run()
    kinds = [row.partition("(")[0] for row in operators]
    assert kinds[0] in ("Move", "LookAt")
    assert "Pick" in kinds
    assert operators[-1] == "Place(sodaE, table2)"
    end = play.turns[-1].end
    assert end is not None
    assert end.status == "goal_achieved"


def test_with_them_the_same_goal_is_achieved_by_the_same_actions(without: Rulebook) -> None:
    """ "... augment": what the planner did before stays as it was."""
    rows = [Play(book, "B(On(sodaE, table2), 0.9)", three_sodas()).run() for book in (without, shipped())]
    assert rows[0] == rows[1]


def test_what_a_description_means_needs_them() -> None:
    """ "So that it can act to interpret and achieve these goals": with them, and only with them."""
    play = Play(shipped(), GREEN_TO_TABLE1, three_sodas(), HUES)
    assert play.run()[-1] == "Place(sodaC, table1)"
    named = {
        step.op.partition("(")[0] for turn in play.turns for p in turn.plans for layer in p.layers for step in layer
    }
    assert "ExamineObj" in named
    text = "".join(Path(name).stem + shipped().files[name].decode() for name in OTHERS if name != "vocabulary.lp")
    assert "examine_obj" not in text
    assert "find_obj" not in text

"""G8: what the paper declares not handled is refused in so many words, never misread."""

import pytest
from kit.papers import shipped

from skolem.reasoner.language.expressions import Goal
from skolem.reasoner.language.parser import parse_goal
from skolem.traces.errors import InputError

NAMES = ("desk", "o2")


def read(goal: str) -> Goal:
    """Return the parsed goal."""
    return parse_goal(goal, shipped().vocabulary.words(), NAMES)


@pytest.mark.parametrize(
    "goal",
    [
        "B(On(the x. Green(x), desk), 0.9)",
        "exists o. B(Den(the x. Green(x), o), 0.9)",
        "exists o. B(Den(iota x. Green(x), o), 0.9)",
        "the o. B(Den(lambda x. Green(x), o), 0.9)",
    ],
)
def test_definite_descriptions_are_refused_by_name(goal: str) -> None:
    """ "Definite descriptions ... are of great importance, but not handled in our current implementation"."""
    with pytest.raises(InputError, match="definite descriptions are not supported"):
        read(goal)


@pytest.mark.parametrize(
    ("goal", "says"),
    [
        ("exists o. B(Den(lambda x. not Green(x), o), 0.9)", "negation is not part of the goal language"),
        ("exists o. B(Den(lambda x. ~Green(x), o), 0.9)", "negation is not part of the goal language"),
        ("forall o. B(On(o, desk), 0.9)", "only existential variables are part of the goal language"),
    ],
)
def test_other_quantifiers_and_negation_are_refused_by_name(goal: str, says: str) -> None:
    """ "Legal expressions include conjunctions, disjunctions, and existential quantification": and no others."""
    with pytest.raises(InputError, match=says):
        read(goal)


@pytest.mark.parametrize("goal", ["put something heavy and green on the desk", "bring me a can, please", "?"])
def test_natural_language_is_refused_with_the_place_where_it_begins(goal: str) -> None:
    """ "Our work focuses on the case where there is no uncertainty about the specification"."""
    with pytest.raises(InputError) as refused:
        read(goal)
    assert any(fault.column for fault in refused.value.faults)


def test_an_ambiguous_goal_is_an_error_and_no_question_is_asked() -> None:
    """ "Robots can additionally use dialog with humans to disambiguate references": this one does not."""
    with pytest.raises(InputError, match="is neither a bound variable nor a known object"):
        read("B(On(it, desk), 0.9)")


def test_indefinite_descriptions_that_several_objects_fit_are_no_error() -> None:
    """ "These denoting expressions are indefinite"."""
    assert len(read("exists o. B(Den(lambda x. Green(x), o), 0.9) & B(On(o, desk), 0.9)").fluents) == 2

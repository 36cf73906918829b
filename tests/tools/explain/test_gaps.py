"""Explanations show both evaluations of a description where they differ."""

from kit.minds import TableBelief, Thing
from kit.papers import shipped

from skolem.reasoner.language.parser import parse_goal
from skolem.tools.explain.gaps import Gap, gaps
from skolem.tools.explain.objects import Choice
from skolem.tools.explain.text import choice_tree
from skolem.traces.wording.things import Things
from skolem.traces.wording.wording import InWords


def belief() -> TableBelief:
    return TableBelief({"a": Thing({"soda": 0.6, "bottle": 0.4}), "b": Thing({"soda": 0.9, "bottle": 0.1})})


def found(description: str) -> tuple[Gap, ...]:
    text = f"exists o. B(Den({description}, o), 0.5)"
    return gaps(parse_goal(text, shipped().vocabulary.words(), ()), shipped(), belief())


def test_the_gap_is_told_of_the_object_for_which_it_is_greatest() -> None:
    """Soda & Soda is soda, but the product squares it: .6 to .36, and .9 to .81."""
    (gap,) = found("lambda x. Soda(x) & Soda(x)")
    assert (gap.expression, gap.object) == ("e1", "a")
    assert abs(gap.worlds - 0.6) < 1e-9
    assert abs(gap.independent - 0.36) < 1e-9


def test_evaluations_that_agree_and_what_the_product_cannot_value_are_not_told_of() -> None:
    assert found("lambda x. Soda(x)") == ()
    assert found("the x. Soda(x)") == ()
    assert found("lambda x. not Soda(x)") == ()


def test_a_gap_is_one_line_of_an_explanation() -> None:
    words = InWords(Things("exists o. B(Den(lambda x. Soda(x) & Green(x), o), 0.5)", frozenset({"soda"})))
    tree = choice_tree(Choice(3, {"e1": "lambda x. Soda(x) & Green(x)"}, (), (Gap("e1", "a", 0.6, 0.36),)), words)
    (line,) = [below.line for below in tree.below]
    assert line == (
        "P(it is the green soda) for a: 0.600 by possible worlds, 0.360 by the paper's product; they differ by 0.240"
    )

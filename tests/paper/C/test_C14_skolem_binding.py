"""C14: a Skolem constant stands for the object that has not been met yet."""

from kit.papers import GREEN_TO_TABLE1, plans, posed, rehearsed, searching

from skolem.reasoner.terms import parse_term

SKOLEM = "sk(var(o))"


def test_the_first_plan_is_about_a_placeholder() -> None:
    """ "To find an object currently named by a Skolem (placeholder) constant Sk, and then to place that object." """
    play, _ = rehearsed("searching")
    assert play.turns[0].decisions[0].plan == (f"FindObj(e1, _reg1_, {SKOLEM})", f"Place({SKOLEM}, table1)")


def test_no_physical_step_on_a_placeholder_is_refined_or_executed() -> None:
    """ "Lambda expressions and existentially quantified variables are not" arguments for operations."""
    for name in ("searching", "example"):
        play, operators = rehearsed(name)
        assert not [op for op in operators if "sk(" in op]
        steps = [step for plan in plans(play) for layer in plan.layers for step in layer]
        placing = [step for step in steps if step.op.startswith("Place(sk(")]
        assert placing
        assert {step.level for step in placing} == {0}
        assert not [step for step in steps if "sk(" in step.op and not step.op.startswith(("Place(", "FindObj("))]


def test_after_the_object_is_seen_later_steps_name_its_anchor() -> None:
    """ "Can be used as anchors to instantiate existentially quantified variables." """
    play, operators = rehearsed("searching")
    (bound,) = plans(play, "bind_skolem")
    assert "Place(_o2_, table1)" in [step.op for step in bound.layers[0]]
    assert operators[-1] == "Place(_o2_, table1)"
    seen = operators.index("LookAtRegion(_reg2_)")
    assert bound.step == seen + 1


def test_a_placeholder_is_bound_to_an_anchor_that_satisfies_everything_said_of_it() -> None:
    """ "exists o. B(Den(expr, o), .9) and ...": clutter that is in place but not denoted is not taken."""
    play = searching()
    play.belief.things |= play.found["_reg1_"] | play.found["_reg2_"]
    play.belief.changed()
    at = posed(GREEN_TO_TABLE1, play.belief)
    den, on = (parse_term(f"b({phi},105361)") for phi in (f"den(e1,{SKOLEM})", f"on({SKOLEM},table1)"))
    assert list(at.satisfied(frozenset({on}))) == [{parse_term(SKOLEM): "_o1_"}]
    assert list(at.satisfied(frozenset({den}))) == [{parse_term(SKOLEM): "_o2_"}]
    assert not list(at.satisfied(frozenset({den, on})))

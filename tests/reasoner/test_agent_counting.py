"""Whole turns about `the`, counts and `every`, with the real rules, on a belief that is a table."""

from kit.minds import Region, Thing
from kit.papers import posed, shipped
from kit.plays import GREEN, RED, Play

from skolem.reasoner.terms import parse_term
from skolem.traces.messages import RunEnd

THE = "exists o. B(Den(the x. Green(x) & Soda(x), o), 0.9) & B(On(o, table1), 0.9)"


def soda(on: str = "table2", hue_sd: float = 0.2) -> Thing:
    return Thing({"soda": 0.9, "bottle": 0.1}, on=on, hsv=(GREEN, 0.9, 0.8), hsv_sd=hue_sd)


def tables() -> dict[str, Thing]:
    return {"table1": Thing({"table": 1.0}), "table2": Thing({"table": 1.0})}


def ended(play: Play) -> tuple[list[str], RunEnd]:
    operators = play.run()
    end = play.turns[-1].end
    assert end is not None
    return operators, end


def test_two_referents_end_the_run_with_both_names_and_what_tells_them_apart() -> None:
    things = tables() | {"a": soda(), "b": soda("table1")}
    operators, end = ended(Play(shipped(), THE, things, {"a": GREEN, "b": GREEN}))
    assert end.status == "no_unique_referent"
    assert "a (0.9" in end.reason
    assert "b (0.9" in end.reason
    assert "a is on table2, b on table1" in end.reason
    assert not any(op.startswith("Pick") for op in operators)


def test_a_word_that_is_true_of_one_alone_tells_them_apart() -> None:
    heavy, light = soda(), soda()
    heavy.ln_kg, light.ln_kg = (-0.3, 0.02), (-2.0, 0.02)
    _, end = ended(Play(shipped(), THE, tables() | {"a": heavy, "b": light}, {"a": GREEN, "b": GREEN}))
    assert end.status == "no_unique_referent"
    assert "a is heavy" in end.reason


def test_the_search_goes_on_until_the_other_is_refuted() -> None:
    things = tables() | {"a": soda(), "b": soda()}
    operators, end = ended(Play(shipped(), THE, things, {"a": GREEN, "b": RED}))
    assert end.status == "goal_achieved"
    assert {"LookAt(a)", "LookAt(b)"} <= set(operators[: operators.index("Pick(a)")])


def test_nothing_is_meant_only_when_nothing_is_left_to_try() -> None:
    things, regions = tables() | {"a": soda()}, {"_reg1_": Region("table2", 0.5)}
    operators, end = ended(Play(shipped(), THE, things, {"a": RED}, regions=regions))
    assert end.status == "no_referent"
    assert "LookAtRegion(_reg1_)" in operators
    assert "_reg1_ (0.95 known)" in end.reason


def test_what_the_region_shows_then_is_the_one() -> None:
    found = {"_reg1_": {"_o1_": soda()}}
    play = Play(
        shipped(),
        THE,
        tables() | {"a": soda()},
        {"a": RED, "_o1_": GREEN},
        regions={"_reg1_": Region("table2", 0.5)},
        found=found,
    )
    operators, end = ended(play)
    assert (end.status, end.anchor) == ("goal_achieved", "_o1_")
    assert operators[-1] == "Place(_o1_, table1)"


def test_an_object_that_is_found_late_joins_those_of_every() -> None:
    sure = Thing({"soda": 0.97, "bottle": 0.03}, on="table2")
    late = Thing({"soda": 0.97, "bottle": 0.03}, on="table2")
    play = Play(
        shipped(),
        "B(every x. Soda(x) -> On(x, table1), 0.9)",
        tables() | {"a": sure},
        regions={"_reg1_": Region("table2", 0.5)},
        found={"_reg1_": {"_o1_": late}},
    )
    operators, end = ended(play)
    assert end.status == "goal_achieved"
    assert {"Place(a, table1)", "Place(_o1_, table1)"} <= set(operators)
    assert operators.index("LookAtRegion(_reg1_)") < operators.index("Place(_o1_, table1)")


def test_distinct_variables_are_never_one_object() -> None:
    goal = "exists distinct o, p. B(Green(o), 0.9) & B(Green(p), 0.9)"
    belief = Play(shipped(), goal, tables() | {"a": soda(hue_sd=0.01)}).belief
    alone = posed(goal, belief)
    assert alone.achieved() is None
    assert posed(goal.replace("distinct ", ""), belief).achieved() is not None
    belief.things["b"] = soda(hue_sd=0.01)
    belief.changed()
    both = posed(goal, belief).achieved()
    assert both is not None
    assert {str(f) for f in both if str(f).startswith("differ")} <= {"differ(a,b)", "differ(b,a)"}


def test_a_placeholder_of_which_only_a_difference_is_said_stays_unbound() -> None:
    at = posed(THE, Play(shipped(), THE, tables() | {"a": soda()}).belief)
    apart = parse_term("differ(a,sk(one_of(s1,0)))")
    assert at.situation.holds(apart)
    assert list(at.satisfied(frozenset({apart}))) == [{}]
    known = frozenset({apart, parse_term("krd(sk(one_of(s1,0)))")})
    bound = [str(term) for binding in at.satisfied(known) for term in binding.values()]
    assert bound
    assert "a" not in bound

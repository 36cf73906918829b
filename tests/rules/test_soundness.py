"""Every inference rule is sound: where all that an instance asks for holds, all that it gives holds."""

import math

import pytest
from hypothesis import given, strategies as st
from kit.minds import TableBelief
from kit.papers import posed
from kit.posed import scenes

from skolem.reasoner.planning.goals import PosedGoal
from skolem.reasoner.planning.patterns import mentions
from skolem.reasoner.terms import nll, parse_term

WORDS = ("soda", "green", "heavy")
CLAIMS = (
    "b(den(e1,{o}),{p})",
    "b(holds((green,soda),{o}),{p})",
    "b(holds((green,heavy,soda),{o}),{p})",
    *(f"b({kind}({word},{{o}}),{{p}})" for kind in ("prop", "supposed") for word in WORDS),
    "clear(pick(right,{o}))",
)


@pytest.mark.parametrize("claim", CLAIMS)
@given(at=scenes(fine=True), spare=st.sampled_from([0, 1, 5, 20_000]), count=st.integers(1, 3))
def test_what_an_inference_asks_for_implies_what_it_gives(claim: str, at: PosedGoal, spare: int, count: int) -> None:
    """Bounds are drawn near what is believed of some properties: there an unsound share is seen."""
    for anchor in at.situation.anchors():
        believed = math.prod(at.situation.prob_word(word, anchor) for word in WORDS[:count])
        fluent = parse_term(claim.format(o=anchor, p=nll(believed) + spare))
        for instance in at.offers.offers(fluent):
            if instance.executes is not None or instance.rejected:
                continue
            if all(map(at.situation.holds, instance.demanded(instance.concrete))):
                assert all(at.situation.holds(given) for given in instance.results if not mentions(given, "sk"))


WIDE = {  # a goal -> what its rules achieve
    "exists o. B(Den(the x. Soda(x), o), {p})": ("den(e1,{o})", "unlike(e1_any,{o})", "none_in(e1_any,_reg0_)"),
    "B(at least 2 x. Soda(x), {p})": ("holds_of_the_world(s1)",),
    "B(exactly 1 x. Soda(x) & Green(x), {p})": ("holds_of_the_world(s1)", "unlike(s1_any,{o})"),
    "B(at most 1 x. Soda(x) & On(x, side), {p})": ("holds_of_the_world(s1)", "unlike(s1_any,{o})"),
    "B(every x. Soda(x) -> On(x, desk), {p})": ("holds_of_the_world(s1)", "unlike(s1_any,{o})"),
    "exists o. B(Den(lambda x. Soda(x) & Green(x), o) & On(o, desk), {p})": ("together(den(e1,{o}),on({o},desk))",),
}


@pytest.mark.parametrize("goal", WIDE)
@given(scene=scenes(most=3, fine=True), p=st.sampled_from([0.3, 0.6, 0.75, 0.9, 0.95]), none=st.integers(0, 2))
def test_what_is_asked_about_numbers_of_objects_implies_what_is_given(
    goal: str, scene: PosedGoal, p: float, none: int
) -> None:
    """Of some objects it is likely that they do not fit; else nothing could be refuted."""
    belief = scene.situation.belief
    assert isinstance(belief, TableBelief)
    for thing in [t for t in belief.things.values() if "soda" in t.types][:none]:
        thing.types = {"soda": thing.types["bottle"], "bottle": thing.types["soda"]}
    for space in belief.spaces.values():
        space.seen = 0.97
    belief.changed()
    at = posed(goal.format(p=p), belief)
    claims = {claim.format(o=o) for claim in WIDE[goal] for o in at.situation.anchors()}
    for claim in sorted(claims):
        if "_reg0_" in claim and "_reg0_" not in belief.regions():
            continue
        for instance in at.offers.offers(parse_term(f"b({claim},{nll(p)})")):
            if instance.executes is None and all(map(at.situation.holds, instance.demanded(instance.concrete))):
                assert all(at.situation.holds(given) for given in instance.results if not mentions(given, "sk"))

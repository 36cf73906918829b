"""Every inference rule is sound: where all that an instance asks for holds, all that it gives holds."""

import math

import pytest
from hypothesis import given, strategies as st
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

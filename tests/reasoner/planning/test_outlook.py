"""The lower bound on what a conjunction still costs."""

from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.planning.outlook import Outlook
from skolem.reasoner.terms import Term, parse_term


def step(name: str, price: int) -> Instance:
    return Instance(parse_term(name), parse_term(name), frozenset({("price", price)}))


OFFERS: dict[Term, tuple[Instance, ...]] = {
    "clean": (step("wash", 7), step("wipe", 10)),
    "dry": (step("wipe", 10),),
    "lit": (step("lamp", 3), step("sun", 0)),
    "warm": (),
}


def outlook(*fluents: Term, unusable: str = "") -> Outlook:
    return Outlook(fluents, lambda f: OFFERS[f], lambda i: str(i.step) != unusable)


def test_each_fluent_costs_at_least_its_cheapest_usable_step() -> None:
    assert outlook("clean", "lit").least(["clean", "lit", "unknown"]) == 7 + 0
    assert outlook("clean", "lit", unusable="sun").least(["clean", "lit"]) == 7 + 3
    assert outlook("clean", "lit").least(["lit"]) == 0


def test_a_step_for_two_fluents_is_not_paid_twice() -> None:
    """To wipe for 10 makes clean and dry; the bound must not exceed that."""
    assert outlook("clean", "dry").least(["clean", "dry"]) == 5 + 5
    assert outlook("dry").least(["clean", "dry"]) == 10


def test_what_nothing_achieves_is_hopeless() -> None:
    assert outlook("clean", "warm").hopeless == {"warm"}
    assert outlook("dry", unusable="wipe").hopeless == {"dry"}


def test_a_step_that_achieves_more_than_it_is_offered_for_is_noticed() -> None:
    known = outlook("clean", "dry")
    assert known.foresaw(parse_term("wipe"), ["clean", "dry", "unknown"])
    assert not known.foresaw(parse_term("wash"), ["dry"])

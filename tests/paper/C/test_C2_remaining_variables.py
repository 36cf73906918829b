"""C2: what matching leaves open is enumerated: the variety of ways."""

from kit.minds import TableBelief, TableGeometry
from kit.papers import EXAMPLE_GOAL, example, posed, preconditions

from skolem.reasoner.planning.goals import PosedGoal
from skolem.reasoner.terms import parse_term


def stage(order: int = 1) -> PosedGoal:
    """The start of the example, with two things in the way of the right hand; anchors in either order."""
    things = example().belief.things
    geometry = TableGeometry()
    geometry.in_the_way = {"pick(right, o2)": ("o1", "o3")}
    return posed(EXAMPLE_GOAL, TableBelief(dict(list(things.items())[::order])), geometry=geometry)


def offered(at: PosedGoal, fluent: str) -> list[str]:
    """Return the instances for a fluent."""
    return [str(instance.step) for instance in at.offers.offers(parse_term(fluent))]


def test_an_object_can_be_picked_with_either_hand() -> None:
    """ "These represent the variety of ways that the operation can be carried out to obtain the same result." """
    assert offered(stage(), "holding(o2)") == ["pick(left,o2)", "pick(right,o2)"]


def test_what_the_goal_says_binds_the_variable() -> None:
    """ "Some variables in theta are bound by matching the operator's results to fluents in the goal." """
    assert offered(stage(), "held(right,o2)") == ["pick(right,o2)"]


def test_both_blockers_are_removed_by_either_hand_and_each_to_any_support() -> None:
    """ "Additional variables in theta that are not yet determined." """
    at = stage()
    (remove,) = at.offers.offers(parse_term("clear(pick(right,o2))"))
    assert {f for f, _ in preconditions(remove)} == {"aside(o1,pick(right,o2))", "aside(o3,pick(right,o2))"}
    for blocker in ("o1", "o3"):
        ways = [
            f"put({hand},{blocker},{support},pick(right,o2))"
            for hand in ("left", "right")
            for support in ("desk", "shelf", "side")
        ]
        assert offered(at, f"aside({blocker},pick(right,o2))") == ways
    assert at.offers.offers(parse_term("clear(pick(left,o2))")) == ()


def test_the_order_is_fixed_whatever_the_order_of_objects() -> None:
    """ "Variety of ways", but no nondeterminism in the planner."""
    fluents = ("holding(o2)", "aside(o1,pick(right,o2))", "b(on(o2,desk),105361)")
    assert [offered(stage(1), f) for f in fluents] == [offered(stage(-1), f) for f in fluents]

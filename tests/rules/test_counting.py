"""The rules about numbers of objects: a fluent in, the exact rule instances out, on a belief that is a table."""

import pytest
from kit.minds import Region, TableBelief, Thing
from kit.papers import only, posed, preconditions, results
from kit.plays import GREEN

from skolem.reasoner.planning.goals import PosedGoal
from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.terms import nll, parse_term

NINE = nll(0.9)
THE = "exists o. B(Den(the x. Soda(x), o), 0.9)"


def soda(p: float) -> Thing:
    return Thing({"soda": p, "bottle": 1.0 - p}, on="table2", hsv=(GREEN, 0.9, 0.8), hsv_sd=0.01)


def scene(goal: str, regions: bool = True, **sodas: float) -> PosedGoal:
    """Return a goal about two tables, and objects on table2 that are sodas with the given probabilities."""
    things = {"table1": Thing({"table": 1.0}), "table2": Thing({"table": 1.0})}
    things |= {name: soda(p) for name, p in sodas.items()}
    spaces = {"_reg1_": Region("table2", 0.05, 0.9)} if regions else {}
    return posed(goal, TableBelief(things, spaces))


def offered(at: PosedGoal, fluent: str) -> dict[str, Instance]:
    return {str(instance.step): instance for instance in at.offers.offers(parse_term(fluent))}


def bounds(instance: Instance) -> dict[str, int]:
    """Return the bound of each belief that an instance needs at once, by what is believed."""
    found = [fluent for fluent, level in preconditions(instance) if level == 0 and fluent.startswith("b(")]
    return {text[2:-1].rpartition(",")[0]: int(text[2:-1].rpartition(",")[2]) for text in found}


def test_the_obj_needs_one_that_fits_and_that_no_other_known_or_hidden_does() -> None:
    at = scene(THE, a=0.97, b=0.02)
    instance = only(at, f"b(den(e1,a),{NINE})")
    assert str(instance.step) == f"only(e1,a,{NINE})"
    assert results(instance) == {f"b(den(e1,a),{NINE})"}
    needed = bounds(instance)
    assert set(needed) == {"den(e1_any,a)", "unlike(e1_any,b)", "none_in(e1_any,_reg1_)"}
    assert sum(needed.values()) <= NINE
    assert needed["unlike(e1_any,b)"] == 2 * nll(0.98)  # it is believed well enough; the least sure gets the rest
    assert needed["den(e1_any,a)"] == NINE - 2 * nll(0.98) - needed["none_in(e1_any,_reg1_)"]
    assert instance.immediate
    assert instance.price == 0


def test_an_object_that_surely_does_not_fit_is_not_asked_about() -> None:
    at = scene(THE, regions=False, a=0.97, b=1e-6)
    assert set(bounds(only(at, f"b(den(e1,a),{NINE})"))) == {"den(e1_any,a)"}


def test_an_object_is_refuted_by_what_it_has_instead() -> None:
    instance = only(scene(THE, a=0.97, b=0.3), f"b(unlike(e1_any,b),{NINE})")
    assert str(instance.operation) == "refute_obj(e1_any,b)"
    assert results(instance) == {f"b(unlike(e1_any,b),{NINE})"}
    assert preconditions(instance) == {
        (f"b(holds((not__soda,),b),{NINE})", 1),
        (f"b(prop(not__soda,b),{nll(0.7) + nll(0.5)})", 0),
    }
    assert instance.costs == {("prior_of_refutation", nll(0.7))}


def test_a_region_is_ruled_out_by_looking_at_as_much_of_it_as_is_needed() -> None:
    at = scene(THE, a=0.97)
    instance = only(at, f"b(none_in(e1_any,_reg1_),{NINE})")
    assert results(instance) == {f"b(none_in(e1_any,_reg1_),{NINE})"}
    hidden = 0.05 * 0.1 * 0.5  # objects expected in the unseen part that are sodas
    assert instance.price == pytest.approx(hidden * 1e6, abs=1)
    assert [reason for reason, _ in instance.costs] == ["prior_of_none"]
    tight = only(at, "b(none_in(e1_any,_reg1_),1250)")
    ((contents, level),) = preconditions(tight)
    assert level == 1
    assert contents == f"b(contents(_reg1_),{nll(1.0 - 0.1 / 2)})"  # half as much may be hidden


def test_a_choice_of_members_is_made_of_known_and_unmet_objects_that_differ() -> None:
    found = offered(scene("B(at least 2 x. Soda(x), 0.9)", a=0.97, b=0.6), f"b(holds_of_the_world(s1),{NINE})")
    first, second = "sk(one_of(s1,0))", "sk(one_of(s1,1))"
    assert set(found) == {
        f"count(s1,{members},{NINE})" for members in ("(a,b)", f"(a,{first})", f"(b,{first})", f"({first},{second})")
    }
    differ = {f for f, _ in preconditions(found[f"count(s1,(a,b),{NINE})"]) if f.startswith("differ")}
    assert differ == {"differ(a,b)"}


def test_a_member_that_is_not_met_yet_gets_an_even_share_of_what_is_left() -> None:
    """It is not known at all yet: no share near zero is asked of the search for it."""
    found = offered(scene("B(at least 2 x. Soda(x), 0.9)", a=0.98, b=0.6), f"b(holds_of_the_world(s1),{NINE})")
    sk = "sk(one_of(s1,0))"
    beside = bounds(found[f"count(s1,(a,{sk}),{NINE})"])
    assert beside == {"den(s1_any,a)": 2 * nll(0.98), f"den(s1_any,{sk})": NINE - 2 * nll(0.98)}
    doubtful = bounds(found[f"count(s1,(b,{sk}),{NINE})"])
    assert set(doubtful.values()) == {NINE // 2}


def test_what_is_counted_on_a_table_can_be_placed_there_and_others_taken_away() -> None:
    at = scene("B(exactly 1 x. Soda(x) & On(x, table2), 0.9)", regions=False, a=0.97, b=0.6)
    instance = offered(at, f"b(holds_of_the_world(s1),{NINE})")[f"count(s1,(a,),{NINE})"]
    assert set(bounds(instance)) == {"den(s1_kind,a)", "on(a,table2)", "unlike(s1_any,b)"}
    ways = offered(at, f"b(unlike(s1_any,b),{NINE})")
    assert preconditions(ways[f"put_away(s1_any,b,table2,{NINE})"]) == {(f"b(off(b,table2),{NINE})", 0)}
    assert any(step.startswith("refute(") for step in ways)


def test_an_exception_to_every_is_put_right() -> None:
    at = scene("B(every x. Soda(x) -> On(x, table1), 0.9)", regions=False, a=0.97)
    instance = only(at, f"b(holds_of_the_world(s1),{NINE})")
    assert set(bounds(instance)) == {"unlike(s1_any,a)"}
    right = offered(at, f"b(unlike(s1_any,a),{NINE})")[f"put_right(s1_any,a,table1,{NINE})"]
    assert preconditions(right) == {(f"b(on(a,table1),{NINE})", 0)}


def test_likelier_members_are_chosen_first_and_the_choices_are_few() -> None:
    sodas = {f"o{k:02}": 0.3 + 0.05 * k for k in range(12)}
    at = scene("B(at least 3 x. Soda(x), 0.9)", regions=False, **sodas)
    found = list(at.offers.offers(parse_term(f"b(holds_of_the_world(s1),{NINE})")))
    assert 0 < len(found) <= 20
    met = [str(i.step) for i in found if "sk(" not in str(i.step)]
    assert 0 < len(met) < len(found)  # however many are known, others may be found
    costs = [sum(nll(sodas[m]) for m in step.split("(")[2].partition(")")[0].split(",") if m) for step in met]
    assert min(costs) == sum(sorted(map(nll, sodas.values()))[:3])
    assert len(set(map(str, (i.step for i in found)))) == len(found)


@pytest.mark.parametrize("count", [2, 3])
def test_facts_of_one_world_get_even_shares_of_what_may_go_wrong(count: int) -> None:
    facts = ["den(e1,a)", "on(a,table1)", "prop(green,a)"][:count]
    goal = "exists o. B(Den(lambda x. Soda(x), o) & On(o, table1) & Green(o), 0.9)"
    nested = facts[-1]
    for fact in reversed(facts[:-1]):
        nested = f"together({fact},{nested})"
    instance = only(scene(goal, a=0.97), f"b({nested},{NINE})")
    needed = bounds(instance)
    assert set(needed) == set(facts)
    assert list(needed.values()) == [pytest.approx(nll(1 - 0.1 / count), abs=1)] * count
    assert instance.immediate

"""The plan stack: choosing, skipping, falling back, popping, and binding placeholders."""

from collections.abc import Iterable

from skolem.reasoner.planning.hierarchy import Binding, PlanStack
from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.planning.regression import Step, Subgoal
from skolem.reasoner.terms import Term, parse_term, substitute


def terms(*texts: str) -> frozenset[Term]:
    return frozenset(map(parse_term, texts))


def step(name: str, preimage: Iterable[str], subgoal: Iterable[str], level: int = 0, concrete: int = 1) -> Step:
    term = parse_term(name)
    needs = frozenset({(parse_term("deep"), concrete)})
    return Step(Instance(term, term, preconditions=needs, executes=term), level, terms(*subgoal), terms(*preimage))


class World:
    """A set of true fluents; the placeholder may stand for any of `anchors`."""

    def __init__(self, *now: str, anchors: tuple[str, ...] = ()) -> None:
        self.now = set(terms(*now))
        self.anchors = anchors

    def satisfied(self, fluents: Subgoal) -> list[Binding]:
        placeholder = parse_term("sk(o)")
        bindings: list[Binding] = [{}, *({placeholder: anchor} for anchor in self.anchors)]
        return [b for b in bindings if {substitute(f, b) for f in fluents} <= self.now]

    def false_in(self, fluents: Subgoal) -> list[Term]:
        return [f for f in fluents if f not in self.now]


def causes(stack: PlanStack, world: World) -> list[str]:
    return [change.cause for change in stack.select(world.satisfied, world.false_in)]


TWO = (step("look", ["far"], ["near"]), step("pick", ["near"], ["held"]))


def test_the_first_step_of_a_new_plan_is_chosen() -> None:
    stack = PlanStack()
    stack.push(TWO)
    assert stack.current() is TWO[0]
    assert causes(stack, World("far")) == []


def test_the_last_step_whose_preimage_holds_is_taken() -> None:
    stack = PlanStack()
    stack.push(TWO)
    assert causes(stack, World("far", "near")) == ["skipped_forward"]
    assert stack.current() is TWO[1]


def test_a_lost_condition_falls_back_to_an_earlier_step() -> None:
    stack = PlanStack()
    stack.push(TWO)
    stack.select(World("near").satisfied, World("near").false_in)
    assert causes(stack, World("far")) == ["fell_back"]
    assert stack.current() is TWO[0]


def test_a_plan_none_of_whose_preimages_holds_is_popped_with_the_false_fluents() -> None:
    stack = PlanStack()
    stack.push(TWO)
    world = World("elsewhere")
    (change,) = stack.select(world.satisfied, world.false_in)
    assert change.cause == "preimage_lost"
    assert [str(f) for f in change.false_fluents] == ["far", "near"]
    assert len(stack) == 0


def test_work_in_progress_does_not_drop_the_plan_it_serves() -> None:
    """Driving makes `far` false; the layer that drives keeps the step above alive."""
    stack = PlanStack()
    stack.push(TWO)
    stack.push([step("move", ["far"], ["on_the_way"]), step("look", ["on_the_way"], ["near"], level=1)])
    assert causes(stack, World("on_the_way")) == ["skipped_forward"]
    assert len(stack) == 2


def test_a_finished_layer_is_dropped_and_the_plan_above_goes_on() -> None:
    stack = PlanStack()
    stack.push(TWO)
    stack.push([step("look", ["far"], ["near"], level=1)])
    world = World("near")
    while causes(stack, world):
        pass
    assert len(stack) == 1
    assert stack.current() is TWO[1]


def test_levels_count_the_same_operation_among_the_steps_being_refined() -> None:
    stack = PlanStack()
    stack.push(TWO)
    look, pick = TWO[0].instance, TWO[1].instance
    assert stack.level_of(look) == 1
    assert stack.level_of(pick) == 0


def test_a_placeholder_is_bound_to_the_anchor_that_satisfies_the_whole_conjunction() -> None:
    stack = PlanStack()
    stack.push(
        [
            step("find", ["region"], ["green(sk(o))", "near(sk(o))"]),
            step("place(sk(o))", ["green(sk(o))", "near(sk(o))"], ["on(sk(o))"]),
        ]
    )
    world = World("green(o1)", "near(o2)", "green(o2)", anchors=("o1", "o2"))
    assert causes(stack, world) == ["bind_skolem", "skipped_forward"]
    current = stack.current()
    assert current is not None
    assert str(current.instance.step) == str(current.instance.operation) == "place(o2)"
    assert current.instance.executes == parse_term("place(o2)")
    assert current.subgoal == terms("on(o2)")


def test_a_placeholder_found_while_a_step_is_refined_is_bound_in_the_plan_above_too() -> None:
    stack = PlanStack()
    stack.push([step("find", ["region"], ["sure(sk(o))"]), step("place(sk(o))", ["sure(sk(o))"], ["on(sk(o))"])])
    seen = step("look(sk(o))", ["likely(sk(o))"], ["sure(sk(o))"], level=1)
    stack.push([step("search", ["region"], ["likely(sk(o))"]), seen])
    world = World("region", "likely(o2)", anchors=("o1", "o2"))
    assert causes(stack, world) == ["bind_skolem", "skipped_forward"]
    layers, chosen = stack.steps()
    assert [[str(s.instance.step) for s in layer] for layer in layers] == [
        ["find", "place(o2)"],
        ["search", "look(o2)"],
    ]
    assert chosen == (0, 1)
    assert causes(stack, world) == []


def test_the_message_shows_layers_levels_and_the_chosen_steps() -> None:
    stack = PlanStack()
    stack.push(TWO)
    world = World("near")
    (change,) = stack.select(world.satisfied, world.false_in)
    plan = stack.message(3, change)
    assert plan.step == 3
    assert plan.current == (1,)
    assert [s.op for s in plan.layers[0]] == ["look", "pick"]


def test_a_placeholder_is_no_anchor_that_cannot_be_used_and_the_search_goes_on_for_another() -> None:
    """Otherwise the robot would give up for what is at hand, although what it seeks may be found."""
    find, place = step("find", ["far"], ["den(sk(o))"]), step("place(sk(o))", ["den(sk(o))"], ["there(sk(o))"])
    stack, world = PlanStack(), World("far", "den(o2)", anchors=("o2", "o3"))
    stack.push((find, place))

    def select() -> list[str]:
        changes = stack.select(world.satisfied, world.false_in, lambda instance, _: instance.step == useless)
        return [change.cause for change in changes]

    useless = parse_term("place(o2)")
    assert select() == []
    assert stack.current() == find
    world.now.add(parse_term("den(o3)"))
    assert select() == ["bind_skolem", "skipped_forward"]
    current = stack.current()
    assert current is not None
    assert current.instance.step == parse_term("place(o3)")

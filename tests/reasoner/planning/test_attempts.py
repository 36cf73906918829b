"""What was tried in vain is counted, forgotten by success and by driving on, and survives the trace."""

from skolem.reasoner.planning.attempts import Attempts
from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.terms import parse_term
from skolem.traces.messages import Limits

LIMITS = Limits(steps=1, expansions=1, hierarchy_depth=12, min_plan_probability=0.5, repeats=3, same_looks=2)
LOOK, DRIVE = "look(o)", "move(look(o))"
KNOWN = parse_term("b(type(o,can),105361)")


def done(command: str) -> Instance:
    term = parse_term(command)
    return Instance(step=term, operation=term, costs=frozenset(), preconditions=frozenset(), executes=term)


def tried(*outcomes: tuple[str, bool]) -> Attempts:
    attempts = Attempts(LIMITS)
    for command, achieved in outcomes:
        attempts.judge(done(command), {} if achieved else {KNOWN: 0.5})
    return attempts


def test_a_step_is_hopeless_after_failures_in_a_row() -> None:
    assert not tried((LOOK, False), (LOOK, False), (LOOK, True), (LOOK, False)).is_hopeless(parse_term(LOOK))
    failed = tried((LOOK, False), (DRIVE, True), (LOOK, False), (LOOK, False))
    assert failed.is_hopeless(parse_term(LOOK))
    assert failed.hopeless() == [parse_term(LOOK)]


def test_what_is_in_vain_here_is_forgotten_by_a_drive_and_by_success() -> None:
    assert tried((LOOK, False)).fruitless_here() == frozenset()
    assert tried((LOOK, False), (LOOK, False)).fruitless_here() == {parse_term(LOOK)}
    assert tried((LOOK, False), (LOOK, False), (DRIVE, False)).fruitless_here() == frozenset()
    assert tried((LOOK, False), (LOOK, False), (LOOK, True)).fruitless_here() == frozenset()


def test_what_failed_is_tried_again_after_another_object_was_moved() -> None:
    failures = [(LOOK, False)] * 3
    assert not tried(*failures, ("pick(left,p)", True)).is_hopeless(parse_term(LOOK))
    assert not tried(*failures, ("place(p,table1,nothing)", True)).is_hopeless(parse_term(LOOK))
    assert tried(*failures, ("pick(left,p)", False)).is_hopeless(parse_term(LOOK))
    assert tried(*failures, ("look(p)", True)).is_hopeless(parse_term(LOOK))
    assert tried(*[("pick(left,o)", False)] * 3, ("pick(right,o)", True)).is_hopeless(parse_term("pick(left,o)"))


def test_counts_survive_the_trace() -> None:
    before = tried((LOOK, False), (LOOK, False), ("pick(left,o)", True))
    assert (before.failures(), before.in_vain()) == ({LOOK: 2}, {LOOK: 2})
    after = Attempts(LIMITS)
    after.recall(before.failures(), before.in_vain(), before.nearest())
    assert (after.failures(), after.in_vain()) == (before.failures(), before.in_vain())
    assert after.nearest() == before.nearest() == {"nearest(look(o),type(o,can))": 0.5}
    assert after.fruitless_here() == before.fruitless_here()


def test_looks_that_bring_a_belief_nearer_than_ever_are_not_counted_as_failed() -> None:
    attempts, look = Attempts(LIMITS), parse_term(LOOK)
    for degree in (0.3, 0.4, 0.5, 0.6, 0.7):
        attempts.judge(done(LOOK), {KNOWN: degree})
    assert not attempts.is_hopeless(look)
    assert not attempts.fruitless_here()
    for degree in (0.6, 0.7, 0.705):  # what goes up and down comes no nearer
        attempts.judge(done(LOOK), {KNOWN: degree})
    assert attempts.is_hopeless(look)


def test_a_tighter_bound_on_the_same_fluent_is_no_progress_by_itself() -> None:
    attempts = Attempts(LIMITS)
    for bound in (400000, 300000, 200000, 100000):
        attempts.judge(done(LOOK), {parse_term(f"b(type(o,can),{bound})"): 0.5})
    assert attempts.is_hopeless(parse_term(LOOK))

"""D4: belief copes with type errors of the detector."""

from kit.papers import STANDS, Handler, at_five_percent, can, seen_as

from skolem.traces.messages import TypeIs

SODA = TypeIs(type="soda")


def after(wrong: int) -> float:
    """Return P(soda) of a can thought one at .95 that a detector right in 9 of 10 cases called a bottle so often."""
    robot = Handler(at_five_percent([can(soda=0.95)], type_right=0.9))
    for _ in range(wrong):
        robot.see(seen_as(STANDS, kind="bottle"))
    return robot.belief.prob_property("can1", SODA)


def test_one_wrong_type_does_not_flip_the_most_likely_one_but_ten_do() -> None:
    """ "Even in the presence of pose and type errors in the perception system." """
    assert after(0) > after(1) > 0.5
    assert after(10) < 0.01


def test_right_types_win_against_a_wrong_one_between_them() -> None:
    """ "... type errors in the perception system": what is seen most often is believed."""
    robot = Handler(at_five_percent([can(soda=0.5)], type_right=0.9))
    for kind in ("soda", "bottle", "soda", "soda"):
        robot.see(seen_as(STANDS, kind=kind))
    assert robot.belief.prob_property("can1", SODA) > 0.95

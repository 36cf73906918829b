"""D5: the left wrist has no force-torque sensor, and who asks for it is told so."""

from pathlib import Path

from minds import Thing
from plays import Play

from skolem.reasoner.queries import Queries
from skolem.reasoner.rulebook import Rulebook

ASKS_THE_LEFT = Path(__file__).parent.parent / "data" / "own_rules" / "weigh_left.lp"
HEAVY = "exists o. B(Den(lambda x. Heavy(x), o), 0.9) & B(In(o, table1), 0.9)"


def robot(impossible: tuple[str, ...] = ()) -> Play:
    """Return one that would weigh a can with its left hand."""
    things = {
        "table1": Thing({"table": 1.0}),
        "table2": Thing({"table": 1.0}),
        "sodaC": Thing({"soda": 1.0}, on="table2"),
    }
    play = Play(Rulebook.load(Queries, [ASKS_THE_LEFT]), HEAVY, things, log_kg={"sodaC": -0.5})
    play.geometry.impossible = set(impossible)
    return play


def test_a_weighing_with_the_left_hand_is_refused_and_the_right_one_does_it() -> None:
    """ "The right wrist has a ... force-torque sensor": what is in the left hand is put into the right one."""
    play = robot()
    operators = play.run()
    refused = [plan.false_fluents for turn in play.turns for plan in turn.plans if plan.cause == "refused"]
    assert refused == [("balance(sodaC)", "held(right,sodaC)")]
    assert not [op for op in operators if op.startswith("Balance")]
    assert operators.index("Pick(sodaC)") < operators.index("Weigh(sodaC)")
    assert operators[-1] == "Place(sodaC, table1)"


def test_where_the_right_hand_cannot_do_it_either_the_end_says_what_the_rule_lacks() -> None:
    """A run that fails for this names the wrist, the object and the remedy."""
    play = robot(impossible=("pick(right, sodaC)",))
    play.run()
    end = play.turns[-1].end
    assert end is not None
    assert end.status == "goal_unachievable"
    assert "weigh(sodaC) was asked for with sodaC in the left hand" in end.reason
    assert "a rule that executes weigh(O) must demand held(right, O)" in end.reason

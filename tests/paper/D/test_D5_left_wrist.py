"""D5: the left wrist has no force-torque sensor, and who asks for it is told so."""

from kit.minds import Thing
from kit.places import DATA
from kit.plays import LIMITS, Play

from skolem.reasoner.agent import Agent
from skolem.reasoner.language.parser import parse_goal
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import Rulebook

ASKS_THE_LEFT = DATA / "own_rules" / "weigh_left.lp"
RULES = Rulebook.load(Queries, [ASKS_THE_LEFT])
HEAVY = "exists o. B(Den(lambda x. Heavy(x), o), 0.9) & B(In(o, table1), 0.9)"


def robot(impossible: tuple[str, ...] = ()) -> Play:
    """Return one that would weigh a can with its left hand."""
    things = {
        "table1": Thing({"table": 1.0}),
        "table2": Thing({"table": 1.0}),
        "sodaC": Thing({"soda": 1.0}, on="table2"),
    }
    play = Play(RULES, HEAVY, things, log_kg={"sodaC": -0.5})
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


def test_what_is_remembered_has_the_objection_so_that_a_recalled_mind_ends_alike() -> None:
    play = robot(impossible=("pick(right, sodaC)",))
    for step in range(20):
        again = Agent(parse_goal(HEAVY, RULES.vocabulary.words()), RULES, play.belief, play.geometry, LIMITS)
        again.recall(play.agent.memory(step))
        recalled, turn = again.decide(step), play.agent.decide(step)
        assert (recalled.action, recalled.end) == (turn.action, turn.end)
        if turn.end is not None:
            assert play.agent.memory(step).objections
            return
        play.carry_out(turn)
    raise AssertionError("the agent never ended")


def test_where_the_right_hand_cannot_do_it_either_the_end_says_what_the_rule_lacks() -> None:
    """A run that fails for this names the wrist, the object and the remedy."""
    play = robot(impossible=("pick(right, sodaC)",))
    play.run()
    end = play.turns[-1].end
    assert end is not None
    assert end.status == "goal_unachievable"
    assert "weigh(sodaC) was asked for with sodaC in the left hand" in end.reason
    assert "a rule that executes weigh(O) must demand held(right, O)" in end.reason

"""C8: plans may be stacked as deep as the problem asks: what is in the way has something in its own way."""

from itertools import pairwise

from kit.minds import Thing
from kit.papers import shipped
from kit.plays import GREEN, Play

from skolem.traces.messages import Pick

CANS = ("back", "middle", "front")  # each hides the one before it from both hands
GOAL = "exists o. B(Den(lambda x. Soda(x) & Green(x) & Heavy(x), o), 0.9) & B(On(o, desk), 0.9)"
DEEP = 12


def in_a_row() -> Play:
    """Return a robot before a table with three cans, of which the last is a heavy green one."""
    things = {name: Thing({"table": 1.0}) for name in ("table", "desk")}
    things |= {name: Thing({"soda": 0.8, "bottle": 0.2}, on="table") for name in CANS}
    play = Play(shipped(), GOAL, things, {"back": GREEN}, {"back": -0.5})
    for name, blocker in pairwise(CANS):
        for hand in ("right", "left"):
            play.geometry.in_the_way[f"pick({hand}, {name})"] = (blocker,)
    return play


def depth(play: Play) -> int:
    """Return how many layers the plan stack had at most when an action was chosen."""
    return max(len(turn.plans[-1].layers) for turn in play.turns if turn.plans and turn.action is not None)


def test_a_stack_of_twelve_layers_is_made_and_carried_out() -> None:
    """ "Refining the initial step" again and again: the first thing done is to take away what is in the way of all."""
    play = in_a_row()
    operators = play.run()
    assert depth(play) >= DEEP
    assert [op for op in operators if op.startswith("Pick")] == ["Pick(front)", "Pick(middle)", "Pick(back)"]
    end = play.turns[-1].end
    assert end is not None
    assert end.status == "goal_achieved"


def test_a_hand_that_puts_an_obstacle_aside_is_empty_for_what_stood_behind() -> None:
    """Both hands must be empty for the last two cans; the first obstacle is taken by one of them all the same."""
    play = in_a_row()
    play.run()
    hands = [command.hand for turn in play.turns if turn.action and isinstance(command := turn.action.command, Pick)]
    assert hands == ["left", "left", "right"]

"""F4, G1, C13: an object that fits the description but perhaps is not there is looked at again, not given up."""

from kit.papers import GREEN_TO_TABLE1, shipped, three_sodas
from kit.plays import GREEN, Play
from kit.runs import ran


def test_an_object_that_perhaps_is_not_there_is_looked_at_before_it_is_given_up() -> None:
    """ "Any objects ... that can be used as anchors": P(Den) has P(exists) as a factor, and a look can raise it."""
    things = three_sodas()
    del things["sodaE"], things["sodaB"]
    sure = things["sodaC"]
    sure.exists, sure.types, sure.hsv, sure.hsv_sd = 0.69, {"soda": 1.0}, (GREEN, 0.9, 0.8), 0.01
    turn = Play(shipped(), GREEN_TO_TABLE1, things).agent.decide(0)
    assert turn.action is not None
    assert turn.action.op in ("Move(look(sodaC))", "LookAt(sodaC)")


def test_seed_4_of_the_third_simulation_ends_with_the_goal() -> None:
    """ "A situation in which the robot ... believes that objects are likely to be found on top of tables"."""
    run = ran("sim3_unknown", 4)
    assert run.achieved
    assert run.verdict.true

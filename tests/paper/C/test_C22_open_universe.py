"""C22: how many objects there are is not known in advance."""

from kit.papers import GREEN_SODA, denotes, plans, posed, rehearsed
from kit.runs import ran
from kit.searches import FRONT, TOP, Searcher, table_prior


def test_the_universe_grows_during_a_run() -> None:
    """ "Fundamental uncertainty even about the dimensionality of the underlying state space." """
    run = ran("sim3_unknown")
    counts = [len(belief.anchors) for belief in run.beliefs]
    assert counts[0] == 3  # the tables
    assert counts[-1] > counts[0]
    dimensions = [len(belief.joint_covariance) for belief in run.beliefs]
    assert dimensions[-1] > dimensions[0]
    discovered = set(run.beliefs[-1].anchors) - set(run.known())
    assert run.end.anchor in discovered
    assert all(anchor.startswith("_o") for anchor in discovered)


def test_the_goal_ranges_over_new_objects_at_once() -> None:
    """ "exists o": over every object that the robot knows of by then."""
    robot = Searcher(table_prior(), [("soda", (1.0, 0.1, TOP, 0.0))])
    assert denotes("lambda x. exists y. (Green(y) & Soda(y))", robot.belief)["table1"] < 0.01
    about = [{str(f) for root in posed(GREEN_SODA, robot.belief).instantiations for f in root}]
    robot.look(FRONT)
    about.append({str(f) for root in posed(GREEN_SODA, robot.belief).instantiations for f in root})
    assert not any("_o1_" in fluent for fluent in about[0])
    assert any("den(e1,_o1_)" in fluent for fluent in about[1])
    assert denotes("lambda x. exists y. (Green(y) & Soda(y))", robot.belief)["table1"] > 0.3


def test_the_turn_after_a_discovery_plans_with_the_new_anchor() -> None:
    """ "The addition of newly postulated objects", and "replans if necessary"."""
    play, operators = rehearsed()
    discovered = operators.index("LookAtRegion(_reg2_)") + 1
    (start,) = [plan for plan in plans(play, "start") if plan.step == discovered]
    assert [step.op for step in start.layers[0]] == ["ExamineObj(e1, _o4_)", "Place(_o4_, desk)"]

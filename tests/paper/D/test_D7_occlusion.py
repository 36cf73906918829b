"""D7: substantial occlusion: what stands behind something is not seen, not believed absent, and found elsewhere."""

import pytest
from kit.papers import STANDS, at_five_percent, can
from kit.runs import Run, with_physics
from kit.searches import BACK, FRONT, REGION, Searcher, table_prior

SCREEN = ("screen", (0.85, 0.0, 0.7, 0.0))  # between FRONT and STANDS


def test_an_object_behind_a_box_is_not_detected_and_not_believed_absent() -> None:
    """ "Both in simulation and on a real physical robot, in the presence of substantial occlusion"."""
    searcher = Searcher(at_five_percent([can()]), [SCREEN, ("soda", STANDS)])
    for _ in range(5):
        searcher.look(FRONT)
    assert searcher.belief.prob_exists("can1") == pytest.approx(0.99)
    assert searcher.belief.anchors() == ("table1", "can1")


def test_space_behind_a_box_stays_unseen_until_it_is_looked_at_from_elsewhere() -> None:
    """ "Searching the space around it ... in the presence of substantial occlusion"."""
    searcher = Searcher(table_prior(), [SCREEN])
    for _ in range(3):
        searcher.look(FRONT)
    behind = searcher.belief.snapshot(0).regions[REGION]
    searcher.look(BACK)
    everywhere = searcher.belief.snapshot(0).regions[REGION]
    assert behind.seen < 0.9 < everywhere.seen
    assert behind.hidden > 2.0 * everywhere.hidden


@pytest.mark.physics
def test_a_hidden_object_is_found_by_driving_to_where_it_is_seen() -> None:
    """ "Searching the space around it": the first look does not show it; over seeds: docs/results.md."""
    run = with_physics("occluded")
    assert run.verdict.witness == "hidden"
    looks = [i for i, row in enumerate(run.operators) if row == "LookAtRegion(_reg1_)"]
    first, found = looks[0], next(i for i in looks if run.end.anchor in run.beliefs[i + 1].anchors)
    assert run.end.anchor not in run.beliefs[first + 1].anchors
    assert "Move(look_region(_reg1_))" in run.operators[first:found]
    assert _share_hidden(run, first + 1) > _share_hidden(run, found + 1)


@pytest.mark.physics
def test_an_object_in_the_way_is_taken_out_of_it() -> None:
    """ "It moves the box, _o1_, out of the way"."""
    run = with_physics("illustrative")
    asked = [question for question in run.questions if question.query == "blockers pick(right, o2)"]
    assert any(question.blockers == ("o1",) for question in asked)
    assert run.where("Pick(o1)") < run.where("Pick(o2)")
    assert run.beliefs[run.where("Pick(o1)")].objects["o2"].exists > 0.9


def _share_hidden(run: Run, decision: int) -> float:
    return run.beliefs[decision].regions["_reg1_"].hidden

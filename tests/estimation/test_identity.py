import numpy as np
import pytest
from kit.beliefs import (
    CANS,
    FIT_SD,
    GREEN,
    GREEN_RGB,
    Robot,
    depth_view,
    detection,
    pose_of,
    prior,
    sees_all,
)

from skolem.estimation.belief import Belief
from skolem.estimation.events import EVENT, Looked, Sighting
from skolem.estimation.se2 import upper
from skolem.traces.messages import HsvBelief, Pose2, TypeIs

HERE, THERE = (0.9, -0.045, 0.0), (0.9, 0.045, 0.0)
SHAKY = upper(np.diag([1e-4, 1e-4, 1e-4]))


def told_twice(apart: float, sd_m: float = 0.012) -> Robot:
    """Return a robot that was told of one can as two, a little apart."""
    return Robot(prior(CANS | {"again": (0.95 + apart, 0.0, 0.0)}, sd_m=sd_m))


def conflated() -> Robot:
    """Return a robot that took two cans for one, which it saw now here, now there."""
    robot = Robot(prior({"can": (0.9, 0.0, 0.0)}))
    for x, y, theta in (HERE, THERE) * 4:
        seen = Sighting(
            anchor="can",
            new=False,
            camera_T_object=(x, y, theta),
            covariance=upper(np.diag([FIT_SD**2, FIT_SD**2, 3.0])),
            z=0.7,
            z_sd_m=0.01,
            odds=10.0,
            detection=detection((x, y, theta)),
        )
        robot.belief.apply(Looked(camera_covariance=SHAKY, sightings=(seen,), missed=()))
    return robot


# ---------------------------------------------------------------- one object


def test_two_anchors_in_one_place_are_one_object_that_keeps_the_first_name() -> None:
    robot = told_twice(0.01)
    sees_all(robot)
    (change,) = robot.belief.snapshot(1).identity
    assert (change.kind, change.anchor, change.other) == ("merged", "can2", "again")
    assert robot.belief.anchors() == ("table1", *CANS)
    assert robot.belief.prob_exists("again") == 0.0
    assert robot.belief.prob_exists("can2") == pytest.approx(0.99)


def test_of_three_anchors_in_one_place_a_look_merges_two_and_the_next_look_the_third() -> None:
    more = {"again": (0.952, 0.0, 0.0), "third": (0.948, 0.0, 0.0)}
    robot = Robot(prior(CANS | more, sd_m=0.012))
    for looks in (1, 2):
        robot.look([detection(CANS["can2"])] * 3)
        assert [change.kind for change in robot.belief.identity_changes()] == ["merged"] * looks
        told = [anchor for anchor in robot.belief.anchors() if anchor in ("table1", *CANS, *more)]
        assert len(told) == len(("table1", *CANS, *more)) - looks


def test_object_of_two_anchors_is_known_as_well_as_by_both() -> None:
    merged, once = told_twice(0.01), Robot(prior(sd_m=0.012))
    sees_all(merged)
    sees_all(once)
    best = once.belief.gaussian("pose", "can2").covariance[:2, :2]
    assert np.linalg.det(merged.belief.gaussian("pose", "can2").covariance[:2, :2]) < np.linalg.det(best)
    told = TypeIs(type="soda")
    assert merged.belief.prob_property("can2", told) > once.belief.prob_property("can2", told)


def test_what_was_told_of_either_is_believed_of_the_one() -> None:
    told = prior(CANS | {"again": (0.951, 0.0, 0.0)}, sd_m=0.012)
    green = HsvBelief(mean=(0.33, 0.8, 0.6), variance=(0.001, 0.01, 0.01))
    objects = (*told.objects[:-1], told.objects[-1].model_copy(update={"colour": green}))
    robot = Robot(told.model_copy(update={"objects": objects}))
    before = robot.belief.prob_property("can2", GREEN)
    robot.look([detection(CANS["can2"], rgb=GREEN_RGB)])
    assert before < 0.2
    assert robot.belief.prob_property("can2", GREEN) > 0.95


@pytest.mark.parametrize("apart", [0.04, 0.08])
def test_anchors_side_by_side_or_at_places_that_disagree_stay_two(apart: float) -> None:
    robot = told_twice(apart, sd_m=0.005)
    robot.look([detection(CANS["can2"]), detection((0.95 + apart, 0.0, 0.0))])
    assert robot.belief.identity_changes() == ()


def test_anchor_that_is_only_vaguely_known_is_not_taken_for_another() -> None:
    robot = told_twice(0.01, sd_m=0.05)
    sees_all(robot)
    assert robot.belief.identity_changes() == ()


def test_held_object_is_no_other() -> None:
    robot = told_twice(0.0)
    robot.pick("again", (0.8, 0.0, 0.78, 0.0), (0.15, 0.0, -0.08, 0.0))
    sees_all(robot)
    assert robot.belief.identity_changes() == ()


# ---------------------------------------------------------------- no room for both


def hides_another(apart: float) -> Robot:
    """Return a robot that was told of two cans in one line of sight, and then sees the one in front again and again."""
    front, behind = CANS["can2"], (0.95 + apart, 0.0, 0.0)
    robot = Robot(prior({"can2": front, "behind": behind}, sd_m=0.002))
    for _ in range(4):
        robot.look([detection(front)], depth_view([front], height=0.3))
    return robot


def test_thing_believed_where_another_is_seen_to_stand_is_given_up_although_it_would_be_hidden() -> None:
    robot = hides_another(0.05)
    assert robot.belief.prob_exists("behind") < 0.01
    assert robot.belief.prob_exists("can2") == pytest.approx(0.99)


def test_hidden_thing_that_has_room_behind_what_is_seen_keeps_its_existence() -> None:
    assert hides_another(0.075).belief.prob_exists("behind") > 0.95


# ---------------------------------------------------------------- two objects


def test_anchor_between_two_things_is_split_into_both() -> None:
    robot = conflated()
    assert pose_of(robot, "can")[1] == pytest.approx(0.0, abs=0.005)
    for _ in range(2):
        robot.look([detection(HERE), detection(THERE)], depth_view([HERE, THERE]))
    (change,) = robot.belief.snapshot(1).identity
    assert (change.kind, change.anchor, change.other) == ("split", "can", None)
    assert robot.belief.anchors() == ("table1", "can", "_o1_")
    places = sorted(pose_of(robot, name)[1] for name in ("can", "_o1_"))
    assert places == pytest.approx([HERE[1], THERE[1]], abs=0.01)


def test_what_was_seen_of_two_things_is_believed_of_neither() -> None:
    robot = conflated()
    assert robot.belief.snapshot(0).objects["can"].colour_seen
    both = [detection(HERE, rgb=GREEN_RGB), detection(THERE, rgb=GREEN_RGB)]
    robot.look(both, depth_view([HERE, THERE]))
    assert robot.belief.prob_property("can", GREEN) > 0.9


def test_anchor_that_is_seen_in_its_place_is_not_split_by_what_is_seen_over_it() -> None:
    robot = Robot(prior())
    sees_all(robot)
    x, y, _ = CANS["can2"]
    over = [(x, y - 0.05, 0.0), (x, y + 0.05, 0.0)]
    robot.look([detection(pose) for pose in (*CANS.values(), *over)], depth_view(CANS.values()))
    assert robot.belief.identity_changes() == ()


def test_second_thing_beside_a_known_one_splits_nothing() -> None:
    robot = Robot(prior())
    sees_all(robot)
    beside = (0.95, 0.07, 0.0)
    robot.look([*(detection(pose) for pose in CANS.values()), detection(beside)], depth_view([*CANS.values(), beside]))
    assert robot.belief.identity_changes() == ()


# ---------------------------------------------------------------- the log


@pytest.mark.parametrize(
    ("robot", "things"),
    [(told_twice(0.01), list(CANS.values())), (conflated(), [HERE, THERE])],
    ids=["merged", "split"],
)
def test_belief_rebuilt_from_its_events_knows_which_is_which(robot: Robot, things: list[Pose2]) -> None:
    robot.look([detection(pose) for pose in things])
    text = [EVENT.dump_json(event) for event in robot.belief.events]
    again = Belief.from_events(EVENT.validate_json(line) for line in text)
    assert robot.belief.identity_changes()
    assert again.snapshot(9) == robot.belief.snapshot(9)

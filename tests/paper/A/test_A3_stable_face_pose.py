"""A3: a pose has four degrees of freedom; the object rests on a stable face."""

from pathlib import Path

import pytest
from kit.papers import Handler, at_five_percent, can, posed, seen_as, with_own_rules
from kit.searches import TOP, TYPES

from skolem.traces.messages import ObjectType


def test_an_object_stays_on_its_face_and_only_its_yaw_turns() -> None:
    """ "Objects are assumed to be resting on a stable face, so the pose has four degrees of freedom." """
    robot = Handler(at_five_percent([can()], odometry_sd_m=0.01, odometry_sd_rad=0.1))
    robot.see(seen_as((1.0, 0.0, TOP + 0.004, 0.0)))
    before = robot.belief.snapshot(0).objects["can1"]
    assert len(before.world_T_object) == 4
    assert len(before.covariance) == 6  # of x, y, theta: a height known by the support, no tilt
    robot.pick("can1")
    robot.place("can1", "table1", (1.1, 0.2, 0.9))
    after = robot.belief.snapshot(0).objects["can1"]
    assert after.world_T_object[2] == pytest.approx(TOP)  # its base is on the table again
    turned = after.world_T_object[3] - before.world_T_object[3]
    assert turned == pytest.approx(0.9, abs=0.05)


def test_a_thing_that_can_lie_or_stand_is_believed_on_either_face() -> None:
    """ "Resting on a stable face": which one is part of what a detection tells."""
    lying = ObjectType(shape="box", size_m=(0.115, 0.066, 0.066), graspable=True)
    prior = at_five_percent([can().model_copy(update={"type": {"soda": 0.5, "soda_lying": 0.5}})])
    robot = Handler(prior.model_copy(update={"types": TYPES | {"soda_lying": lying}}))
    told = seen_as((1.0, 0.0, TOP, 0.3))
    for kind, other in (("soda_lying", "soda"), ("soda", "soda_lying"), ("soda", "soda_lying")):
        robot.see(told.model_copy(update={"type_log_likelihood": {kind: 0.0, other: -40.0}}))
        types = robot.belief.snapshot(0).objects["can1"].type
        most_likely = max(types, key=types.__getitem__)
    assert most_likely == "soda"
    assert 0.0 < types["soda_lying"] < 0.5


def test_a_rule_file_adds_the_second_face(tmp_path: Path) -> None:
    """ "A fixed finite set of possible object types": a face of a type is a word with a shape of its own."""
    book = with_own_rules(tmp_path, "type(soda_lying). box(soda_lying, 115, 66, 66). graspable(soda_lying).\n")
    assert book.vocabulary.types["soda_lying"].size_m == (0.115, 0.066, 0.066)
    robot = Handler(at_five_percent([can()]))
    goal = "exists o. B(Den(lambda x. Soda(x) | SodaLying(x), o), 0.9) & B(On(o, table1), 0.9)"
    assert posed(goal, robot.belief, book).achieved() is None

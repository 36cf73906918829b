"""What the geometry of the world without physics answers, and that it works there."""

import math

import pytest
from kit.symbolic_worlds import BODIES, DRIVE, do, geometry, picking, thing, world

from skolem.sim.truth.bodies import TrueBody
from skolem.traces.messages import Activity, Pick, Weigh


@pytest.mark.parametrize("name", ["green", "red"])
def test_what_geometry_says_can_be_done_works_in_the_world(name: str) -> None:
    there, pick, place = world(), Activity("pick", name, "right"), Activity("place", name, "right", "table2")
    assert geometry(there).ready(pick) is None
    drive = geometry(there).approach(pick)
    assert drive is not None
    do(there, drive)
    grasp = geometry(there).ready(pick)
    assert isinstance(grasp, Pick)
    assert do(there, grasp, 1)[0].status == "done"
    assert geometry(there, grasp.tool_T_object).ready(place) is None
    drive = geometry(there, grasp.tool_T_object).approach(place)
    assert drive is not None
    do(there, drive, 2)
    release = geometry(there, grasp.tool_T_object).ready(place)
    assert release is not None
    assert do(there, release, 3)[0].status == "done"
    assert thing(there, name).on == "table2"


def test_a_look_from_the_answer_sees_its_object() -> None:
    there = world()
    look = geometry(there).ready(Activity("look", "red"))
    assert look is not None
    assert any(math.dist(d.base_T_object[:2], (1.1, -0.3)) < 1e-6 for d in do(there, look)[1].detections)


def test_what_is_too_far_to_look_at_is_approached() -> None:
    table = TrueBody("table9", "table", (4.0, 0.0, 0.0, 0.0), (0.1, 0.5, 0.6), 30.0)
    far = (*BODIES, table, TrueBody("blue", "soda", (3.75, 0.0, 0.68, 0.0), (0.6, 0.9, 0.8), 0.35))
    there, look = world(bodies=far), Activity("look", "blue")
    assert geometry(there).ready(look) is None
    drive = geometry(there).approach(look)
    assert drive is not None
    do(there, drive)
    assert geometry(there).ready(look) is not None


def test_places_keep_clear_of_what_stands_on_the_table() -> None:
    crowd = [
        TrueBody(f"can{i}{j}", "soda", (0.9 + 0.2 * i + 0.1, -0.5 + 0.2 * j, 0.68, 0.0), (0.6, 0.9, 0.8), 0.35)
        for i in range(4)
        for j in range(6)
        if (i, j) != (0, 2)
    ]
    there = world(bodies=(*BODIES[:2], *crowd, TrueBody("held", "soda", (0.0, -1.4, 0.68, 0.0), (0.3, 1, 1), 0.3)))
    drive = geometry(there).approach(Activity("pick", "held", "right"))
    assert drive is not None
    do(there, drive)
    grasp = geometry(there).ready(Activity("pick", "held", "right"))
    assert isinstance(grasp, Pick)
    do(there, grasp, 1)
    drive = geometry(there, grasp.tool_T_object).approach(Activity("place", "held", "right", "table1"))
    assert drive is not None
    do(there, drive, 2)
    release = geometry(there, grasp.tool_T_object).ready(Activity("place", "held", "right", "table1"))
    assert release is not None
    do(there, release, 3)
    nearest = min(
        math.dist(thing(there, can.id).world_T_object[:2], thing(there, "held").world_T_object[:2]) for can in crowd
    )
    assert nearest > 0.066 + 0.05


def test_an_object_in_the_hand_is_neither_looked_at_nor_picked() -> None:
    there = world()
    do(there, DRIVE)
    do(there, picking(1.05, 0.1), 1)
    for activity in (Activity("look", "green"), Activity("pick", "green", "left")):
        assert geometry(there).ready(activity) is None
        assert geometry(there).approach(activity) is None
    assert geometry(there).ready(Activity("weigh", "green", "right")) == Weigh(hand="right")

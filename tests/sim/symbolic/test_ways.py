"""Corridors and lines of sight of the symbolic robot: what is believed of them, and what they do in the world."""

import dataclasses
import math

import pytest
from kit.symbolic_worlds import BODIES, DRIVE, TYPES, belief_of, do, geometry, picking, thing, world

from skolem.sim.space.activities import is_other_side
from skolem.sim.symbolic.corridors import CORRIDOR_M, HAND_M, Pillar, standing_in
from skolem.sim.symbolic.geometry import SymbolicGeometry
from skolem.sim.symbolic.world import SymbolicWorld
from skolem.sim.truth.bodies import TrueBody
from skolem.traces.messages import Activity, LookAt, Pick, Place

PICK, LOOK = Activity("pick", "it", "right"), Activity("look", "it")
TARGET = TrueBody("it", "soda", (1.12, 0.0, 0.68, 0.0), (0.33, 0.9, 0.8), 0.35)


def thing_at(name: str, x: float, y: float, kind: str = "bottle") -> TrueBody:
    return TrueBody(name, kind, (x, y, 0.68, 0.0), (0.6, 0.9, 0.8), 0.35)


def among(*things: TrueBody) -> SymbolicWorld:
    return world(bodies=(*BODIES[:2], TARGET, *things))


def ring(count: int, radius: float) -> list[TrueBody]:
    angles = [2.0 * math.pi * k / count for k in range(count)]
    return [
        thing_at(f"n{k}", 1.12 + radius * math.cos(angle), radius * math.sin(angle)) for k, angle in enumerate(angles)
    ]


# ---------------------------------------------------------------- corridors


@pytest.mark.parametrize(
    ("x", "y", "bottom", "blocks"),
    [
        (0.5, 0.0, 0.0, True),
        (0.5, 0.08, 0.0, True),
        (0.5, 0.10, 0.0, False),
        (1.1, 0.0, 0.0, False),
        (-0.1, 0.0, 0.0, False),
        (0.5, 0.0, 0.3, False),
    ],
    ids=["in the middle", "touching its side", "beside it", "behind the target", "behind the robot", "above it"],
)
def test_a_corridor_ends_at_the_target_and_has_a_width(x: float, y: float, bottom: float, blocks: bool) -> None:
    target = Pillar("it", 1.0, 0.0, 0.03, 0.0, 0.2)
    other = Pillar("other", x, y, 0.03, bottom, bottom + 0.2)
    assert standing_in((0.0, 0.0), target, [target, other], CORRIDOR_M) == (("other",) if blocks else ())


def test_a_pick_fails_in_the_world_if_something_stands_in_the_way_of_the_hand() -> None:
    for y, status in ((0.1, "failed"), (0.1 + HAND_M + 0.04, "done")):
        there = world(bodies=(*BODIES, thing_at("guard", 0.94, y)))
        do(there, DRIVE)
        result, _ = do(there, picking(1.05, 0.1), 1)
        assert result.status == status
        assert thing(there, "green").in_hand == ("right" if status == "done" else None)


def test_a_guarded_can_is_not_ready_to_be_picked_and_its_guard_is_named() -> None:
    there = among(thing_at("guard", 0.98, 0.0))
    assert geometry(there).approach(PICK) is None
    assert geometry(there).blockers(PICK) == ("guard",)
    do(there, DRIVE.model_copy(update={"start_T_waypoint": ((0.5, 0.0, 0.0),)}))
    assert geometry(there).ready(PICK) is None
    assert geometry(there).blockers(PICK) == ("guard",)
    assert geometry(among()).blockers(PICK) == ()


def test_another_edge_of_the_table_may_be_free() -> None:
    corner = TrueBody("it", "soda", (1.05, 0.42, 0.68, 0.0), (0.33, 0.9, 0.8), 0.35)
    there = world(bodies=(*BODIES[:2], corner, thing_at("guard", 0.95, 0.42)))
    drive = geometry(there).approach(PICK)
    assert drive is not None
    assert geometry(there).blockers(PICK) == ()
    do(there, drive)
    grasp = geometry(there).ready(PICK)
    assert grasp is not None
    assert do(there, grasp, 1)[0].status == "done"


def test_blockers_are_those_of_the_way_with_the_fewest() -> None:
    corner = TrueBody("it", "soda", (1.05, 0.42, 0.68, 0.0), (0.33, 0.9, 0.8), 0.35)
    front = [thing_at("front1", 0.95, 0.40), thing_at("front2", 0.95, 0.47)]
    there = world(bodies=(*BODIES[:2], corner, *front, thing_at("side", 1.05, 0.54)))
    assert geometry(there).blockers(PICK) == ("side",)


def test_what_is_taken_out_of_the_way_is_put_where_it_is_not_in_it() -> None:
    there, step = among(*ring(8, 0.14)), 0
    [blocker] = geometry(there).blockers(PICK) or ()
    take = Activity("pick", blocker, "right")
    do(there, geometry(there).approach(take) or LookAt(pan=0.0, tilt=0.0), step)
    grasp = geometry(there).ready(take)
    assert isinstance(grasp, Pick)
    do(there, grasp, 1)
    believed = geometry(there, grasp.tool_T_object)
    assert believed.blockers(PICK) == ()
    put = Activity("place", blocker, "right", "table1", PICK)
    release = believed.ready(put)
    if release is None:
        do(there, believed.approach(put) or LookAt(pan=0.0, tilt=0.0), 2)
        release = geometry(there, grasp.tool_T_object).ready(put)
    assert isinstance(release, Place)
    do(there, release, 3)
    assert geometry(there).blockers(PICK) == ()


# ---------------------------------------------------------------- room on a table


def crowd(kind: str, step: float, but: int = -1) -> list[TrueBody]:
    """Return things of a type all over the first table, the first one in its corner; one of them may be left out."""
    rows, columns = round(0.66 / step) + 1, round(1.06 / step) + 1
    spots = [(0.97 + i * step, -0.53 + j * step) for i in range(rows) for j in range(columns)]
    return [thing_at(f"n{k}", x, y, kind) for k, (x, y) in enumerate(spots) if k != but]


PLACE = Activity("place", "other", None, "table1")
OTHER = TrueBody("other", "soda", (0.0, -1.4, 0.68, 0.0), (0.3, 1.0, 1.0), 0.3)


def test_a_full_table_names_what_takes_the_room_for_an_object_that_no_hand_holds_yet() -> None:
    full = world(bodies=(*BODIES[:2], OTHER, *crowd("soda", 0.132)))
    blockers = geometry(full).blockers(PLACE)
    assert blockers is not None
    assert len(blockers) == 1
    left = world(bodies=(*BODIES[:2], OTHER, *crowd("soda", 0.132, but=int(blockers[0][1:]))))
    assert geometry(left).blockers(PLACE) == ()


def test_a_table_full_of_what_no_hand_lifts_has_no_room() -> None:
    believed = SymbolicGeometry(TYPES | {"soda": TYPES["soda"].model_copy(update={"graspable": False})})
    believed.sync(belief_of(world(bodies=(*BODIES[:2], *crowd("soda", 0.132), thing_at("other", 0.0, -1.4)))))
    assert believed.blockers(PLACE) is None
    assert believed.blockers(Activity("place", "other", None, "table2")) == ()


def test_an_object_takes_no_room_from_itself() -> None:
    alone = world(bodies=(*BODIES[:2], OTHER, *crowd("soda", 0.145)))
    assert geometry(alone).blockers(PLACE) != ()
    assert geometry(alone).blockers(Activity("place", "n0", None, "table1")) == ()


def test_what_makes_room_is_not_put_back_into_it() -> None:
    full = world(bodies=(*BODIES[:2], OTHER, *crowd("soda", 0.132)))
    believed = SymbolicGeometry(TYPES)
    believed.sync(belief_of(full))
    room = believed._room(PLACE)
    assert room is not None
    is_clear = believed._is_clear(PLACE, TYPES["soda"], "table1")
    assert not is_clear((1.3 + room.spot[0], room.spot[1], 0.68, 0.0))
    assert not is_clear((1.3 + room.spot[0], room.spot[1] - 0.12, 0.68, 0.0))
    assert is_clear((1.3 + room.spot[0], room.spot[1] - 0.13, 0.68, 0.0))
    assert believed._is_clear(PLACE, TYPES["soda"], "table2")((1.3 + room.spot[0], room.spot[1], 0.68, 0.0))


# ---------------------------------------------------------------- lines of sight


def test_what_is_hidden_from_here_is_looked_at_from_elsewhere() -> None:
    there = among(thing_at("screen", 1.05, 0.0))
    assert geometry(there).ready(LOOK) is None
    assert geometry(there).blockers(LOOK) == ()
    drive = geometry(there).approach(LOOK)
    assert drive is not None
    do(there, drive)
    look = geometry(there).ready(LOOK)
    assert look is not None
    assert any(
        "soda" in d.type_log_likelihood and d.type_log_likelihood["soda"] == 0.0 for d in do(there, look)[1].detections
    )


def test_what_was_looked_at_from_here_in_vain_is_looked_at_from_another_side() -> None:
    there = among()
    again = dataclasses.replace(LOOK, elsewhere=True)
    assert geometry(there).ready(LOOK) is not None
    assert geometry(there).ready(again) is None
    assert geometry(there).blockers(again) == ()
    here, drive = there.state(0).world_T_base, geometry(there).approach(again)
    assert drive is not None
    do(there, drive)
    assert is_other_side(there.state(0).world_T_base, here, TARGET.world_T_object)
    assert geometry(there).ready(LOOK) is not None


def test_what_is_believed_to_be_in_a_thing_does_not_hide_it() -> None:
    there = among(thing_at("screen", 1.08, 0.0))
    assert geometry(there).ready(LOOK) is not None
    assert geometry(there).ready(Activity("look", "screen")) is not None
    assert geometry(among(thing_at("screen", 1.05, 0.0))).ready(LOOK) is None


def test_what_stands_in_a_hidden_object_as_is_believed_is_no_hider_to_be_named() -> None:
    walls = [thing_at(f"n{k}", 1.12 + x, y) for k, (x, y) in enumerate(((-0.075, 0.0), (0.075, 0.0), (0.0, 0.075)))]
    there = among(*walls, *ring(10, 0.075), thing_at("within", 1.13, 0.0))
    blockers = geometry(there).blockers(LOOK) or ()
    assert blockers
    assert "within" not in blockers


def test_something_lower_hides_nothing() -> None:
    there = among(thing_at("low", 0.99, 0.0, "soda"))
    assert geometry(there).ready(LOOK) is not None


def test_what_hides_an_object_from_all_sides_is_named() -> None:
    there = among(*ring(10, 0.075))
    assert geometry(there).approach(LOOK) is None
    blockers = geometry(there).blockers(LOOK) or ()
    assert 1 <= len(blockers) < 6
    left = among(*(body for body in ring(10, 0.075) if body.id not in blockers))
    assert geometry(left).approach(LOOK) is not None


def test_where_something_would_hide_an_object_it_is_not_put() -> None:
    believed = SymbolicGeometry(TYPES)
    believed.sync(belief_of(among()))
    is_clear = believed._is_clear(LOOK, TYPES["bottle"], "table1")
    assert not is_clear((1.04, 0.0, 0.68, 0.0))
    assert is_clear((1.04, 0.25, 0.68, 0.0))
    assert is_clear((1.25, 0.0, 0.68, 0.0))

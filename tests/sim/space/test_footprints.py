"""Shapes seen from above: gaps, overlaps, overhangs."""

import math

import pytest
from hypothesis import given, strategies as st

from skolem.sim.space.footprints import Footprint, collide, distance, footprint, overhang, overlaps
from skolem.traces.messages import ObjectType, Pose2, Pose4
from skolem.traces.messages.poses import compose2

CAN = ObjectType(shape="cylinder", size_m=(0.06, 0.06, 0.1), graspable=True)
TABLE = ObjectType(shape="table", size_m=(0.8, 1.2, 0.7), graspable=False)
angles = st.floats(-math.pi, math.pi)
places = st.floats(-2.0, 2.0)
poses = st.tuples(places, places, angles)


def at(x: float, y: float, theta: float = 0.0, half: tuple[float, float] = (0.4, 0.6)) -> Footprint:
    return Footprint((x, y, theta), half, 0.0)


@pytest.mark.parametrize(
    ("other", "gap"),
    [
        (at(1.0, 0.0), 0.2),
        (at(0.8, 0.0), 0.0),
        (at(0.0, 0.0), 0.0),
        (at(0.0, 0.0, math.pi / 2, (0.1, 2.0)), 0.0),  # a cross: no corner of one lies in the other
        (at(1.1, 1.6), math.hypot(0.3, 0.4)),
        (Footprint((0.5, 0.0, 0.0), (0.0, 0.0), 0.03), 0.07),
    ],
)
def test_distance_is_the_gap_between_outlines(other: Footprint, gap: float) -> None:
    assert distance(at(0.0, 0.0), other) == pytest.approx(gap, abs=1e-12)


@given(poses, poses, poses)
def test_distance_is_symmetric_and_does_not_depend_on_the_frame(a: Pose2, b: Pose2, frame: Pose2) -> None:
    one, two = at(*a), at(*b, half=(0.05, 0.3))
    moved = (at(*compose2(frame, a)), at(*compose2(frame, b), half=(0.05, 0.3)))
    assert distance(one, two) == pytest.approx(distance(two, one), abs=1e-9)
    assert distance(*moved) == pytest.approx(distance(one, two), abs=1e-9)


def test_tables_side_by_side_do_not_overlap_but_tables_in_each_other_do() -> None:
    assert not overlaps(at(0.0, 0.0), at(0.8, 0.0))
    assert overlaps(at(0.0, 0.0), at(0.79, 0.0))


@pytest.mark.parametrize(
    ("world_T_can", "inside"),
    [((0.04, 0.0, 0.7, 1.0), True), ((0.08, 0.0, 0.7, 1.0), False), ((0.04, 0.0, 0.9, 1.0), False)],
    ids=["in it", "beside it", "on top of it"],
)
def test_two_things_are_in_one_another_if_they_overlap_at_the_same_height(world_T_can: Pose4, inside: bool) -> None:
    box = ObjectType(shape="box", size_m=(0.06, 0.09, 0.2), graspable=True)
    can = ObjectType(shape="cylinder", size_m=(0.06, 0.06, 0.1), graspable=True)
    world_T_box = (0.0, 0.0, 0.7, 0.0)
    assert collide(box, world_T_box, can, world_T_can) is inside
    assert collide(can, world_T_can, box, world_T_box) is inside


@pytest.mark.parametrize(("x", "y", "beyond"), [(0.0, 0.0, -0.37), (0.4, 0.0, 0.03), (0.0, 0.5, -0.07)])
def test_overhang_counts_from_the_nearest_edge_of_the_turned_table(x: float, y: float, beyond: float) -> None:
    world_T_table = (1.0, 2.0, 0.7)
    can = footprint(CAN, compose2(world_T_table, (x, y, 0.3)))
    assert overhang(can, footprint(TABLE, world_T_table)) == pytest.approx(beyond)

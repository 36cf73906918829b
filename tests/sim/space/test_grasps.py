import math

import numpy as np
import pytest

from skolem.sim.space import grasps
from skolem.traces.messages import ObjectType, Pose4
from skolem.traces.messages.poses import compose4

CAN = ObjectType(shape="cylinder", size_m=(0.066, 0.066, 0.115), graspable=True)
BOX = ObjectType(shape="box", size_m=(0.06, 0.09, 0.14), graspable=True)
TABLE = ObjectType(shape="table", size_m=(0.8, 1.2, 0.68), graspable=False)
NOTHING = np.empty((0, 3))


def test_the_tool_and_the_object_in_it_make_up_the_object_s_pose() -> None:
    base_T_object: Pose4 = (0.7, -0.2, 0.68, 1.1)
    grasp = grasps.grasp(CAN, base_T_object, 0.4)
    assert compose4(grasp.base_T_tool, grasp.tool_T_object) == pytest.approx(base_T_object)
    assert grasp.base_T_tool[2] - base_T_object[2] == pytest.approx(0.6 * 0.115)


def test_a_can_is_grasped_from_many_sides_and_whatever_way_it_stands() -> None:
    yaws = grasps.approach_yaws(CAN, 0.0)
    assert len(yaws) == grasps.YAWS
    assert np.array_equal(yaws, grasps.approach_yaws(CAN, 2.0))


@pytest.mark.parametrize("theta", [-2.0, -0.3, 0.5, 1.5, 2.6])
def test_the_fingers_close_on_the_narrow_side_of_a_box(theta: float) -> None:
    yaws = grasps.approach_yaws(BOX, theta)
    assert len(yaws) >= 1
    assert np.abs(np.cos(yaws - theta)) == pytest.approx(0.0, abs=1e-9)  # along y: 6 cm lie between the fingers


def test_a_box_whose_narrow_side_faces_away_is_not_grasped_from_here() -> None:
    assert len(grasps.approach_yaws(BOX, 0.0)) == 0


def test_what_does_not_fit_between_the_fingers_is_not_grasped() -> None:
    thick = ObjectType(shape="cylinder", size_m=(0.09, 0.09, 0.2), graspable=True)
    crate = ObjectType(shape="box", size_m=(0.2, 0.2, 0.2), graspable=True)
    assert [len(grasps.approach_yaws(kind, 0.0)) for kind in (thick, crate, TABLE)] == [0, 0, 0]


def test_open_fingers_before_a_grasp_clear_the_doubt_about_the_place() -> None:
    assert grasps.back_off(CAN, 0.0) == grasps.BACK_OFF_M
    assert grasps.back_off(CAN, 0.05) - grasps.FINGERTIP_M >= 0.05 + 0.033
    assert grasps.back_off(BOX, 0.05) - grasps.FINGERTIP_M >= 0.05 + math.hypot(0.03, 0.045)


def test_every_spot_keeps_its_distance_to_the_edge() -> None:
    places, room = grasps.spots(TABLE, CAN, NOTHING)
    edge = np.array([0.4, 0.6]) - np.abs(places)
    assert edge.min() >= grasps.EDGE_M - 1e-9
    assert room == pytest.approx(np.minimum(edge.min(axis=1), grasps.ENOUGH_M))
    assert (np.diff(room) <= 1e-9).all()


def test_no_spot_crowds_a_neighbour() -> None:
    places, _ = grasps.spots(TABLE, CAN, np.array([[0.1, 0.2, 0.033]]))
    gap = np.hypot(places[:, 0] - 0.1, places[:, 1] - 0.2) - 0.033 - 0.033
    assert gap.min() >= grasps.NEIGHBOUR_M
    assert 0 < len(places) < len(grasps.spots(TABLE, CAN, NOTHING)[0])


def test_a_table_that_is_too_small_has_no_spot() -> None:
    stool = ObjectType(shape="table", size_m=(0.1, 0.1, 0.4), graspable=False)
    assert len(grasps.spots(stool, CAN, NOTHING)[0]) == 0

import math

import numpy as np
import pytest

from skolem.sim.planner import stances
from skolem.sim.planner.stances import BASE_HALF_M, Footprint
from skolem.traces.messages import Pose2
from skolem.traces.messages.poses import compose2, inverse2

SQUARE = Footprint((2.0, 0.0, 0.0), (0.4, 0.6))


def at(*poses: Pose2) -> stances.Floats:
    return np.array(poses)


def test_clearance_is_the_gap_between_facing_edges() -> None:
    found = stances.clearance(at((1.0, 0.0, 0.0), (2.0, 1.5, math.pi / 2.0)), SQUARE)
    assert found == pytest.approx([0.6 - BASE_HALF_M, 0.9 - BASE_HALF_M])


def test_clearance_counts_a_turned_corner() -> None:
    corner = math.hypot(BASE_HALF_M, BASE_HALF_M)
    assert stances.clearance(at((0.0, 0.0, math.pi / 4.0)), SQUARE) == pytest.approx([1.6 - corner])


def test_overlap_is_negative_also_where_no_corner_lies_inside() -> None:
    plank = Footprint((0.0, 0.0, 0.3), (3.0, 0.05))
    assert stances.clearance(at((0.0, 0.0, 0.0), (2.0, 0.1, 0.0)), SQUARE).tolist()[1] < 0.0
    assert stances.clearance(at((0.1, 0.0, 0.0)), plank)[0] < 0.0


def test_clearance_does_not_depend_on_the_frame() -> None:
    world_T_other: Pose2 = (0.7, -0.3, 1.1)
    base: Pose2 = (0.9, 0.8, 0.4)
    moved = Footprint(compose2(world_T_other, SQUARE.world_T_middle), SQUARE.half)
    there = stances.clearance(at(compose2(world_T_other, base)), moved)
    assert there == pytest.approx(stances.clearance(at(base), SQUARE))


def test_a_stance_puts_the_target_at_the_offset() -> None:
    targets, offsets = np.array([[1.0, 2.0]]), np.array([[0.6, -0.2]])
    found, _ = stances.around(targets, np.zeros(1), offsets, np.ones((1, 24)), stances.headings(0.3), (0.0, 0.0, 0.0))
    assert len(found.world_T_base) == 24
    for x, y, theta in found.world_T_base:
        base_T_target = compose2(inverse2((float(x), float(y), float(theta))), (1.0, 2.0, 0.0))
        assert base_T_target[:2] == pytest.approx((0.6, -0.2))


def test_poor_offsets_are_left_out_and_a_short_drive_is_preferred() -> None:
    offsets, quality = np.array([[0.6, 0.0], [0.7, 0.0]]), np.array([[1.0, 1.0], [0.1, 0.1]])
    found, cost = stances.around(
        np.array([[1.0, 0.0]]), np.zeros(1), offsets, quality, np.array([0.0, math.pi]), (0.0, 0.0, 0.0)
    )
    assert len(cost) == 2
    assert found.world_T_base[int(np.argmin(cost))] == pytest.approx([0.4, 0.0, 0.0])


def test_only_clear_stances_are_left_and_roomy_ones_come_first() -> None:
    poses = at((1.6, 0.0, 0.0), (1.19, 0.0, 0.0), (1.0, 0.0, 0.0))
    left = stances.standable(stances.Stances(poses, np.arange(3)), np.zeros(3), [SQUARE])
    assert left.target.tolist() == [2, 1]

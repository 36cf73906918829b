import numpy as np
import pytest

from skolem.sim.robot import ik, reach
from skolem.traces.messages import HANDS, Hand, Pose4
from skolem.traces.messages.arm import CARRY

TOOL: Pose4 = (0.65, -0.2, 0.75, 0.2)


def test_the_best_configuration_comes_first_and_none_is_at_a_limit() -> None:
    found = reach.reaching("right", 0.2, [TOOL, (0.6, -0.3, 0.75, 0.0)], np.array(CARRY["right"]))
    assert (np.diff(found.cost) >= -1e-9).all()
    assert reach.limit_margin("right", found.joints).min() >= reach.LEAST_MARGIN_RAD
    assert set(found.pose.tolist()) == {0, 1}


def test_the_elbow_of_the_best_configuration_is_not_far_below_the_tool() -> None:
    found = reach.reaching("right", 0.2, [TOOL], np.array(CARRY["right"]))
    assert reach.elbow_height(0.2, found.joints[:1])[0] > TOOL[2] - 0.05


def test_no_pose_has_no_configuration() -> None:
    assert len(reach.reaching("left", 0.2, [], np.array(CARRY["left"])).cost) == 0
    assert len(reach.reaching("left", 0.2, [(3.0, 0.0, 0.7, 0.0)], np.array(CARRY["left"])).cost) == 0


@pytest.mark.parametrize("hand", HANDS)
def test_where_the_map_says_so_the_arm_reaches_beside_it_too(hand: Hand) -> None:
    found = reach.reach_map(hand, 0.2, 0.75, 0.12, 0.10)
    good = np.argwhere(found.works == 1.0)
    assert len(good) > 100
    for offset, yaw in good[:: len(good) // 20]:
        x, y = found.offsets[offset]
        for dx, dy in ((0.1, 0.0), (-0.1, 0.1), (0.0, -0.1)):
            tool: Pose4 = (float(x + dx), float(y + dy), 0.75, float(reach.MAP_YAWS[yaw]))
            assert len(reach.reaching(hand, 0.2, [tool], np.zeros(7)).cost) > 0


def test_the_left_map_mirrors_the_right() -> None:
    right, left = (reach.reach_map(hand, 0.2, 0.75, 0.12, 0.10) for hand in HANDS)
    mirrored = {(round(x, 3), round(-y, 3)): q for (x, y), q in zip(right.offsets, right.quality(), strict=True)}
    for (x, y), quality in zip(left.offsets, left.quality(), strict=True):
        assert quality == pytest.approx(mirrored[round(x, 3), round(y, 3)])


def test_a_single_sideways_direction_is_worth_less_than_a_straight_one() -> None:
    found = reach.reach_map("right", 0.2, 0.75, 0.12, 0.10)
    straight, sideways = found.quality(np.array([0.0])), found.quality(np.array([1.0]))
    assert straight.max() == 1.0
    assert 0.0 < sideways.max() < 1.0
    assert found.quality(np.empty(0)).max() == 0.0


def test_rotations_turn_about_the_vertical() -> None:
    turned = reach.rotations(np.array([np.pi / 2.0]))[0] @ np.array([1.0, 0.0, 5.0])
    assert turned == pytest.approx([0.0, 1.0, 5.0])
    assert len(ik.pan_grid("right", 5)) == 5

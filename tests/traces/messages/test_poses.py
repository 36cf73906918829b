import math

import numpy as np
import pytest

from skolem.sim.robot.rotations import rotation
from skolem.traces.messages import Pose2, Pose4, poses

ROUND_OFF = 1e-12


def random_poses(seed: int, count: int = 40) -> list[Pose4]:
    rng = np.random.default_rng(seed)
    return [(float(x), float(y), float(z), float(a)) for x, y, z, a in rng.uniform(-3.0, 3.0, (count, 4))]


def matrix(a_T_b: Pose4) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    out = np.eye(4)
    out[:3, :3] = rotation(a_T_b[3])
    out[:3, 3] = a_T_b[:3]
    return out


def test_composition_is_the_product_of_matrices() -> None:
    for a, b in zip(random_poses(0), random_poses(1), strict=True):
        assert np.allclose(matrix(poses.compose4(a, b)), matrix(a) @ matrix(b), atol=ROUND_OFF)


def test_a_pose_and_its_inverse_cancel() -> None:
    for a in random_poses(2):
        assert poses.compose4(a, poses.inverse4(a)) == pytest.approx((0.0,) * 4, abs=ROUND_OFF)
        assert poses.compose2(poses.inverse2(poses.flat(a)), poses.flat(a)) == pytest.approx((0.0,) * 3, abs=ROUND_OFF)


def test_flat_composition_forgets_height_alone() -> None:
    for a, b in zip(random_poses(3), random_poses(4), strict=True):
        assert poses.flat(poses.compose4(a, b)) == poses.compose2(poses.flat(a), poses.flat(b))


def test_angles_come_back_in_one_turn() -> None:
    for wrap in (poses.wrap_half_open, poses.wrap_exactly):
        assert wrap(-math.pi) == -math.pi
        assert wrap(7.0) == pytest.approx(7.0 - 2.0 * math.pi)
    assert poses.wrap_half_open(math.pi) == -math.pi
    assert poses.wrap_exactly(math.pi) == math.pi


def test_to_wrap_exactly_rounds_nothing_and_to_wrap_half_open_does() -> None:
    assert poses.wrap_exactly(0.1) == 0.1
    assert poses.wrap_half_open(0.1) == pytest.approx(0.1, abs=ROUND_OFF)
    assert poses.wrap_half_open(0.1) != 0.1


def test_heading_undoes_a_quaternion_about_z() -> None:
    for theta in np.linspace(-3.1, 3.1, 13):
        assert poses.heading(poses.quaternion_xyzw(float(theta))) == pytest.approx(theta, abs=ROUND_OFF)


def test_raising_and_flattening_are_inverse() -> None:
    ground: Pose2 = (1.0, -2.0, 0.5)
    assert poses.flat(poses.raised(ground, 0.7)) == ground

import math

import numpy as np
import pytest
from kit.tabletop import EXACT

from skolem.sim.truth.noise import (
    RANGE_M,
    Purpose,
    axial_sd,
    extrinsic_covariance,
    extrinsic_error,
    noisy_depth,
    odometry_error,
    stream,
    wrist_error,
)

DRAWS = 4000
THREE_SD = 3.0 * math.sqrt(2.0 / DRAWS)  # relative, of an estimated variance


def test_equal_keys_give_equal_draws() -> None:
    assert stream(3, 7, Purpose.DEPTH).random(5).tolist() == stream(3, 7, Purpose.DEPTH).random(5).tolist()


@pytest.mark.parametrize("other", [(4, 7, Purpose.DEPTH), (3, 8, Purpose.DEPTH), (3, 7, Purpose.ODOMETRY)])
def test_another_seed_step_or_purpose_gives_another_draw(other: tuple[int, int, Purpose]) -> None:
    assert stream(3, 7, Purpose.DEPTH).random() != stream(*other).random()


def test_purposes_keep_their_numbers() -> None:
    assert [(purpose.name, purpose.value) for purpose in Purpose] == [
        ("DEPTH", 1),
        ("EXTRINSICS", 2),
        ("COLOUR", 3),
        ("MISSED", 4),
        ("CONFUSED", 5),
        ("FALSE_ALARM", 6),
        ("ODOMETRY", 7),
        ("WRIST", 8),
        ("WRIST_BIAS", 9),
        ("TABLES", 10),
    ]


def test_scale_zero_leaves_depth_exact_within_range() -> None:
    depth = np.linspace(0.1, 5.0, 50)[None].repeat(2, axis=0)
    reported = noisy_depth(depth, 0.0, stream(0, 0, Purpose.DEPTH))
    valid = (depth >= RANGE_M[0]) & (depth <= RANGE_M[1])
    assert np.array_equal(reported[valid], depth[valid])
    assert np.isnan(reported[~valid]).all()


@pytest.mark.parametrize("distance", [0.8, 1.3, 2.0])
def test_depth_noise_grows_as_the_kinects_does(distance: float) -> None:
    reported = noisy_depth(np.full((100, 100), distance), 1.0, stream(0, 0, Purpose.DEPTH))
    step = distance**2 / (8.0 * 575.8 * 0.075)  # depth between two disparities
    expected = math.hypot(float(axial_sd(np.array(distance))), step / math.sqrt(12.0))
    assert reported.std() == pytest.approx(expected, rel=0.1)
    assert reported.mean() == pytest.approx(distance, abs=0.1 * step)


def test_depth_comes_in_steps_of_an_eighth_of_a_pixel_of_disparity() -> None:
    reported = noisy_depth(np.full((20, 20), 1.5), 1.0, stream(0, 0, Purpose.DEPTH))
    eighths = 8.0 * 575.8 * 0.075 / reported
    assert np.abs(eighths - np.round(eighths)).max() < 1e-9


def test_half_of_the_pixels_on_depth_edges_return_nothing() -> None:
    depth = np.full((400, 40), 1.0)
    depth[:, 20:] = 1.5
    lost = np.isnan(noisy_depth(depth, 1.0, stream(0, 0, Purpose.DEPTH)))
    on_edge = lost[:, 19:21]
    assert on_edge.mean() == pytest.approx(0.5, abs=3.0 * 0.5 / math.sqrt(on_edge.size))
    assert not np.delete(lost, (19, 20), axis=1).any()


def test_extrinsic_covariance_is_that_of_the_draws() -> None:
    noise = EXACT.model_copy(update={"extrinsics_sd_m": 0.01, "extrinsics_sd_rad": 0.02})
    seen_from_camera = np.array([1.1, -0.4, -0.7])
    draws, moved = stream(0, 0, Purpose.EXTRINSICS), []
    for _ in range(DRAWS):
        error = extrinsic_error(noise, draws)
        shift = error.turn @ seen_from_camera + error.shift - seen_from_camera
        moved.append([shift[0], shift[1], math.atan2(error.turn[1, 0], error.turn[0, 0])])
    expected = extrinsic_covariance(noise, seen_from_camera)
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    assert np.abs((np.cov(np.array(moved).T) - expected) / scale).max() < THREE_SD


def test_odometry_errs_more_the_farther_the_base_moves() -> None:
    noise = EXACT.model_copy(
        update={"odometry_sd_m": 0.005, "odometry_sd_per_m": 0.02, "odometry_sd_rad": 0.01, "odometry_sd_per_rad": 0.1}
    )
    draws = stream(0, 0, Purpose.ODOMETRY)
    errors = np.array([odometry_error(noise, (3.0, 4.0, -0.5), draws) for _ in range(DRAWS)])
    assert errors.var(axis=0) == pytest.approx([0.105**2, 0.105**2, 0.06**2], rel=THREE_SD)


def test_a_drive_that_leads_nowhere_errs_by_the_fixed_part_only() -> None:
    noise = EXACT.model_copy(update={"odometry_sd_per_m": 0.5, "odometry_sd_per_rad": 0.5})
    assert odometry_error(noise, (0.0, 0.0, 2.0 * math.pi), stream(0, 0, Purpose.ODOMETRY)) == pytest.approx((0, 0, 0))


def test_the_wrists_bias_is_one_per_run() -> None:
    noise = EXACT.model_copy(update={"wrist_drift_newton": 0.5})
    assert np.array_equal(wrist_error(noise, 1, 3), wrist_error(noise, 1, 9))
    assert not np.array_equal(wrist_error(noise, 1, 3), wrist_error(noise, 2, 3))


def test_wrist_noise_is_one_per_reading() -> None:
    noise = EXACT.model_copy(update={"wrist_sd_newton": 0.5})
    assert not np.array_equal(wrist_error(noise, 1, 3), wrist_error(noise, 1, 9))

import math

import numpy as np
import pytest
from kit.tabletop import TYPES
from numpy.typing import NDArray

from skolem.sim.detector.fitting import UNKNOWN_YAW_SD_RAD, fit_type

NOISE_M = 0.002
CAMERA_XY = np.zeros(2)


def seen_side(name: str, x: float, y: float, theta: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return feet and heights of points on the sides of a thing that face the origin, with noise."""
    draws, kind = np.random.Generator(np.random.PCG64(0)), TYPES[name]
    half = np.array(kind.size_m[:2]) / 2.0
    around = np.linspace(-math.pi, math.pi, 400, endpoint=False)
    ring = np.column_stack([np.cos(around), np.sin(around)])
    outline = ring * half if kind.shape == "cylinder" else ring / np.abs(ring / half).max(axis=1)[:, None]
    normal = ring if kind.shape == "cylinder" else np.where(np.abs(outline) >= half - 1e-9, np.sign(outline), 0.0)
    turn = np.array([[math.cos(theta), math.sin(theta)], [-math.sin(theta), math.cos(theta)]])
    feet, facing = outline @ turn + (x, y), normal @ turn
    feet = feet[(facing * feet).sum(axis=1) < 0.0]
    return feet + draws.normal(size=feet.shape) * NOISE_M, np.linspace(0.015, kind.size_m[2], len(feet))


@pytest.mark.parametrize("name", ["bottle", "carton", "soda"])
@pytest.mark.parametrize("theta", [-1.2, 0.0, 0.7])
def test_the_right_type_is_the_likeliest_and_its_pose_is_found(name: str, theta: float) -> None:
    feet, heights = seen_side(name, 1.0, -0.3, theta)
    fits = {other: fit_type(feet, heights, CAMERA_XY, TYPES[other]) for other in ("bottle", "carton", "soda")}
    off = {other: abs(fit.height_error_m) + fit.outline_error_m for other, fit in fits.items()}
    assert min(off, key=off.__getitem__) == name
    assert fits[name].xy_theta[:2] == pytest.approx([1.0, -0.3], abs=0.003)


@pytest.mark.parametrize("theta", [-1.2, 0.0, 0.7, 1.5, 2.6])
def test_a_boxs_heading_is_found_modulo_half_a_turn(theta: float) -> None:
    found = fit_type(*seen_side("carton", 1.0, -0.3, theta), CAMERA_XY, TYPES["carton"]).xy_theta[2]
    assert -math.pi / 2.0 <= found < math.pi / 2.0
    assert math.sin(found - theta) == pytest.approx(0.0, abs=0.05)


def test_a_cylinder_has_no_heading() -> None:
    fit = fit_type(*seen_side("soda", 1.0, 0.2, 0.5), CAMERA_XY, TYPES["soda"])
    assert fit.xy_theta[2] == 0.0
    assert fit.covariance[2].tolist() == [0.0, 0.0, UNKNOWN_YAW_SD_RAD**2]


def test_points_of_a_second_thing_lie_outside_the_outline() -> None:
    feet, heights = seen_side("soda", 1.0, 0.0, 0.0)
    both = np.concatenate([feet, np.add(feet, (0.0, 0.08))])
    assert fit_type(feet, heights, CAMERA_XY, TYPES["soda"]).outside == 0.0
    assert fit_type(both, np.tile(heights, 2), CAMERA_XY, TYPES["soda"]).outside > 0.2


def test_noise_makes_no_top_higher() -> None:
    feet, heights = seen_side("soda", 1.0, 0.2, 0.0)
    top = np.random.Generator(np.random.PCG64(1)).normal(TYPES["soda"].size_m[2], NOISE_M, len(heights) // 2)
    fit = fit_type(np.concatenate([feet, feet[: len(top)]]), np.concatenate([heights, top]), CAMERA_XY, TYPES["soda"])
    assert abs(fit.height_error_m) < 0.001

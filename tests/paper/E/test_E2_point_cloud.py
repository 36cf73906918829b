"""E2: a Kinect on the head gives coloured point clouds."""

import colorsys

import numpy as np
import pytest
from kit.runs import Stage
from kit.tabletop import CLEAR, GREEN, TABLE, TABLE_M, can, seen_cloud
from scipy.spatial.transform import Rotation

from skolem.sim.space.pinhole import pixel_rays
from skolem.sim.truth.noise import axial_sd
from skolem.traces.messages import LookAt

pytestmark = pytest.mark.physics

SODA_HALF_M, SODA_M = 0.04, 0.115


def test_points_lie_on_what_they_are_of_within_the_sensors_stated_error() -> None:
    """ "A Kinect sensor generates colored point clouds"; the error along the axis is the one of `axial_sd`."""
    cloud = seen_cloud([TABLE, ("soda", (1.0, 0.0, TABLE_M, 0.0), GREEN)], CLEAR)
    x, y, z = cloud.points_base.T
    top = (np.abs(y) > 0.2) & (x > 0.85) & (x < 1.3) & (np.abs(z - TABLE_M) < 0.05)
    distance = np.linalg.norm(cloud.points_base[top] - cloud.camera_base, axis=1)
    stated = axial_sd(distance)
    assert np.count_nonzero(top) > 2000
    assert 0.2 < np.std(z[top]) / stated.mean() < 1.5
    assert abs(np.mean(z[top]) - TABLE_M) < stated.mean()


def test_points_have_the_colours_of_what_they_are_of() -> None:
    """ "Colored point clouds": the paint's hue, darkened by the stated gain."""
    cloud = seen_cloud([TABLE, ("soda", (1.0, 0.0, TABLE_M, 0.0), GREEN)], CLEAR)
    x, y, z = cloud.points_base.T
    soda = (np.hypot(x - 1.0, y) < SODA_HALF_M) & (z > TABLE_M + 0.02) & (z < TABLE_M + SODA_M - 0.02)
    hue, _, value = colorsys.rgb_to_hsv(*cloud.rgb[soda].mean(axis=0))
    assert np.count_nonzero(soda) > 100
    assert hue == pytest.approx(GREEN[0], abs=0.03)
    assert value == pytest.approx(CLEAR.colour_gain * GREEN[2], abs=0.1)


def test_the_camera_turns_with_the_head() -> None:
    """ "The robot has a base, two arms and head": what is seen is where the head looks."""
    with Stage([can()]) as stage:
        there = stage.do(LookAt(pan=0.0, tilt=0.8))[1].view
        aside = stage.do(LookAt(pan=1.5, tilt=0.0))[1]
    assert there is not None
    assert aside.detections == ()
    depth = np.reshape(there.depth_mm, (there.rows, there.columns, 1)) / 1000.0
    axes = Rotation.from_quat(there.base_T_camera[3:]).as_matrix()
    points = (pixel_rays(there.columns, there.rows) * depth) @ axes.T + there.base_T_camera[:3]
    assert np.mean(np.abs(points[..., 2][depth[..., 0] > 0.0] - TABLE_M) < 0.01) > 0.2

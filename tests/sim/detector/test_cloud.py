import math

import numpy as np
import pytest
from kit.tabletop import HEAD, NO_ERROR, TABLE, TABLE_M, picture
from scipy.spatial.transform import Rotation

from skolem.sim.detector.cloud import ABOVE_PX, BORDER_PX, cloud_from_depth, depth_view, misplaced, without_own_body
from skolem.sim.space.pinhole import Frame, pixel_rays
from skolem.sim.truth.noise import Extrinsics

RENDERER_M = 2e-4  # depth buffers hold 32-bit floats
ORIGIN = Frame(np.zeros(3), np.eye(3))


def test_points_of_a_table_lie_on_its_top() -> None:
    image = picture([TABLE])
    cloud = cloud_from_depth(image.depth, image.rgb / 255.0, HEAD, NO_ERROR)
    behind_its_front = cloud.points_base[:, 0] > 0.76
    top = cloud.points_base[(image.body == 1).ravel() & behind_its_front & (cloud.points_base[:, 2] > TABLE_M - 0.03)]
    assert np.abs(top[:, 2] - TABLE_M).max() < RENDERER_M


def test_pixels_without_return_give_no_point() -> None:
    depth = np.full((8, 8), 1.0)
    depth[2, 3] = math.nan
    assert len(cloud_from_depth(depth, np.zeros((8, 8, 3)), ORIGIN, NO_ERROR).points_base) == 63


def test_a_calibration_error_moves_all_points_as_one_body() -> None:
    depth, rgb = np.linspace(1.0, 2.0, 64).reshape(8, 8), np.zeros((8, 8, 3))
    error = Extrinsics(Rotation.from_rotvec([0.01, -0.02, 0.03]).as_matrix(), np.array([0.01, 0.0, -0.01]))
    exact, off = (cloud_from_depth(depth, rgb, ORIGIN, e).points_base for e in (NO_ERROR, error))
    assert off == pytest.approx(exact @ error.turn.T + error.shift)


def test_a_calibration_error_misplaces_the_view_as_it_does_the_points() -> None:
    depth = np.linspace(1.0, 2.0, 64).reshape(8, 8)
    error = Extrinsics(Rotation.from_rotvec([0.01, -0.02, 0.03]).as_matrix(), np.array([0.01, 0.0, -0.01]))
    points = cloud_from_depth(depth, np.zeros((8, 8, 3)), HEAD, error).points_base
    believed = misplaced(HEAD, error)
    rays = (pixel_rays(8, 8) * depth[..., None]).reshape(-1, 3)
    assert points == pytest.approx(rays @ believed.axes.T + believed.origin)


def test_border_pixels_are_marked() -> None:
    cloud = cloud_from_depth(np.ones((20, 30)), np.zeros((20, 30, 3)), ORIGIN, NO_ERROR)
    assert np.count_nonzero(~cloud.at_border) == (20 - 2 * BORDER_PX) * (30 - 2 * BORDER_PX)


def test_points_under_something_nearer_are_marked() -> None:
    depth = np.full((20, 10), 2.0)
    depth[5:8, :4] = 1.0
    cloud = cloud_from_depth(depth, np.zeros((20, 10, 3)), ORIGIN, NO_ERROR)
    marked = np.argwhere(cloud.under_nearer.reshape(20, 10))
    assert marked.min(axis=0).tolist() == [8, 0]
    assert marked.max(axis=0).tolist() == [7 + ABOVE_PX, 3]


def test_points_near_a_limb_are_left_out() -> None:
    cloud = cloud_from_depth(np.ones((20, 30)), np.zeros((20, 30, 3)), ORIGIN, NO_ERROR)
    limb = np.array([[[1.0, 0.0, 0.0], [1.0, 0.3, 0.0]]])
    left = without_own_body(cloud, limb, 0.1).points_base
    beside = np.hypot(cloud.points_base[:, 1] - np.clip(cloud.points_base[:, 1], 0.0, 0.3), cloud.points_base[:, 2])
    assert len(left) == np.count_nonzero(beside > 0.1)


def test_the_coarse_view_holds_readings_of_exactly_its_own_rays() -> None:
    fine = pixel_rays(320, 240)
    depth = fine[..., 1] + 3.0 * fine[..., 2] + 5.0  # tells every ray from every other
    view = depth_view(depth, ORIGIN)
    coarse = pixel_rays(view.columns, view.rows)
    expected = np.round(1000.0 * (coarse[..., 1] + 3.0 * coarse[..., 2] + 5.0))
    assert (view.columns, view.rows) == (80, 60)
    assert np.array_equal(np.reshape(view.depth_mm, (view.rows, view.columns)), expected)


def test_the_coarse_view_says_zero_where_nothing_returned() -> None:
    assert set(depth_view(np.full((240, 320), math.nan), ORIGIN).depth_mm) == {0}


def test_the_coarse_view_carries_the_cameras_frame() -> None:
    x, y, z, *quaternion = depth_view(np.ones((240, 320)), HEAD).base_T_camera
    assert (x, y, z) == pytest.approx(HEAD.origin)
    assert Rotation.from_quat(quaternion).as_matrix() == pytest.approx(HEAD.axes)

"""Edges of a top in a picture: only what is certain is one."""

import numpy as np
import pytest
from kit.tabletop import EXACT, GREEN, HEAD, RED, TABLE, TABLE_M, Placed, looking, seen_cloud
from numpy.typing import NDArray

from skolem.sim.detector.cloud import Cloud, without_own_body
from skolem.sim.detector.edges import Top, tops
from skolem.sim.detector.supports import find_supports
from skolem.sim.space.pinhole import Frame

FOCAL_PX = 285.0
DEPTH, WIDTH = 0.7, 1.1  # of the table
MIDDLE_X = 1.1
NEAR_M = 0.012  # half a pixel on the far edge


def largest(things: list[Placed], frame: Frame = HEAD, own: float | None = None) -> Top:
    """Return the top of the table; `own`: where a limb of the robot hides it, y in metres."""
    cloud: Cloud = seen_cloud(things, EXACT, frame=frame)
    if own is not None:
        cloud = without_own_body(cloud, np.array([[[0.7, own, TABLE_M], [1.5, own, TABLE_M]]]), 0.08)
    supports = find_supports(cloud.points_base, cloud.camera_base, FOCAL_PX)
    table = min(supports, key=lambda support: abs(float(np.median(support.points[:, 2])) - TABLE_M))
    return tops(cloud, table)[0]


def off_outline(top: Top) -> NDArray[np.float64]:
    """Return how far each edge point is from the table's outline, shape (k,), metres."""
    x, y = np.abs(top.edge[:, 0] - MIDDLE_X) - DEPTH / 2.0, np.abs(top.edge[:, 1]) - WIDTH / 2.0
    return np.minimum(np.abs(x), np.abs(y))


def test_edge_points_lie_on_the_outline_and_face_outward() -> None:
    top = largest([TABLE])
    assert len(top.edge) > 300
    assert np.quantile(off_outline(top), 0.98) < NEAR_M
    near = np.abs(top.edge[:, 0] - (MIDDLE_X - DEPTH / 2.0)) < NEAR_M
    assert (top.outward[near & (np.abs(top.edge[:, 1]) < 0.4), 0] < 0.0).all()


def test_the_border_of_the_image_is_no_edge() -> None:
    top = largest([TABLE], looking((0.9, 0.0, 1.3), (1.0, 0.0, TABLE_M)))
    assert len(top.inside) > 10_000
    assert len(top.edge) == 0


@pytest.mark.parametrize("name", ["bottle", "carton", "soda"])
def test_what_stands_on_a_table_makes_no_edges(name: str) -> None:
    top = largest([TABLE, (name, (0.9, 0.1, TABLE_M, 0.4), GREEN), (name, (1.2, -0.2, TABLE_M, 0.0), RED)])
    assert np.quantile(off_outline(top), 0.98) < NEAR_M


def test_where_the_own_arm_was_cut_out_is_no_edge() -> None:
    top = largest([TABLE], own=0.2)
    assert np.quantile(off_outline(top), 0.98) < NEAR_M


def test_rays_cross_the_plane_on_the_table() -> None:
    inside = largest([TABLE]).inside
    beside = (np.abs(inside - (MIDDLE_X, 0.0)) - (DEPTH / 2.0, WIDTH / 2.0)).max(axis=1)
    assert np.quantile(beside, 0.95) < NEAR_M

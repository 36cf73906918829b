import numpy as np
import pytest
from kit.tabletop import CLEAR, EXACT, HEAD, RED, SHAKY, TABLE, TABLE_M, Placed, looking, seen_cloud

from skolem.sim.detector.cloud import Cloud
from skolem.sim.detector.detect import MAX_DISTANCE_M
from skolem.sim.detector.supports import Support, find_supports
from skolem.sim.space.pinhole import ROWS, focal_px

LOW_TABLE: Placed = ("low_table", (0.45, -0.7, 0.0, 0.0), (0.08, 0.46, 0.65))
HEIGHT_SD_M = 0.003


def supports_of(cloud: Cloud) -> tuple[Support, ...]:
    cloud = cloud.only(np.linalg.norm(cloud.points_base - cloud.camera_base, axis=1) < MAX_DISTANCE_M)
    return find_supports(cloud.points_base, cloud.camera_base, focal_px(ROWS))


def test_a_table_and_the_floor_are_two_supports_highest_first() -> None:
    heights = [support.z_at(1.1, 0.0) for support in supports_of(seen_cloud([TABLE], CLEAR))]
    assert heights == pytest.approx([TABLE_M, 0.0], abs=HEIGHT_SD_M)


def test_two_tables_of_different_height_are_two_supports() -> None:
    frame = looking((-0.3, -0.3, 1.5), (0.6, -0.5, 0.5))
    heights = [support.z_at(0.7, -0.5) for support in supports_of(seen_cloud([TABLE, LOW_TABLE], CLEAR, frame=frame))]
    assert heights == pytest.approx([TABLE_M, 0.45, 0.0], abs=HEIGHT_SD_M)


@pytest.mark.parametrize("step", range(6))
def test_a_tilted_cloud_gives_the_tilted_plane(step: int) -> None:
    cloud, flat = seen_cloud([TABLE], SHAKY, step), seen_cloud([TABLE], EXACT)
    table = supports_of(cloud)[0]
    assert supports_of(flat)[0].normal == pytest.approx([0.0, 0.0, 1.0], abs=1e-3)
    assert np.abs(table.height(table.points)).mean() < HEIGHT_SD_M
    assert len(table.points) == pytest.approx(len(supports_of(flat)[0].points), rel=0.1)


def test_a_thing_is_no_support() -> None:
    crowd: list[Placed] = [("carton", (1.0, y, TABLE_M, 0.0), RED) for y in (-0.3, -0.1, 0.1, 0.3)]
    assert len(supports_of(seen_cloud([TABLE, *crowd], CLEAR))) == 2


def test_a_plane_covers_what_is_above_it_and_little_beside() -> None:
    table = supports_of(seen_cloud([TABLE], EXACT))[0]
    places = np.array([[1.1, 0.0, 0.8], [0.74, 0.0, 0.8], [0.6, 0.0, 0.8]])
    assert table.covers(places, 0.03).tolist() == [True, True, False]


def test_no_point_no_support() -> None:
    assert find_supports(np.empty((0, 3)), HEAD.origin, focal_px(ROWS)) == ()

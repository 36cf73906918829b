import math

import numpy as np
import pytest

from skolem.estimation.coverage import Coverage, Grid
from skolem.traces.messages import ObjectType

SIZE = (0.6, 0.9, 0.3)
GRID = Grid(SIZE, 0.03)
CAN = ObjectType(shape="cylinder", size_m=(0.066, 0.066, 0.115), graspable=True)
CARTON = ObjectType(shape="box", size_m=(0.06, 0.24, 0.14), graspable=True)


NOWHERE = np.zeros(len(GRID.centres), dtype=bool)


def nothing_known() -> Coverage:
    return Coverage(GRID, GRID.window(CAN.size_m), np.zeros(len(GRID.centres), dtype=bool))


def test_voxels_fill_the_box_exactly() -> None:
    grid = Grid((0.5, 0.77, 0.31), 0.03)
    assert grid.step == pytest.approx(0.03, rel=0.05)
    assert (grid.centres.min(axis=0) - grid.step / 2) == pytest.approx((-0.25, -0.385, 0.0))
    assert (grid.centres.max(axis=0) + grid.step / 2) == pytest.approx((0.25, 0.385, 0.31))
    assert len(grid.centres) == math.prod(grid.shape)


def test_nothing_known_hides_a_thing_anywhere() -> None:
    coverage = nothing_known()
    assert (coverage.contents, coverage.hidden) == (0.0, 1.0)


def test_nothing_fits_into_a_slit_thinner_than_the_thing() -> None:
    coverage = nothing_known().with_known(np.abs(GRID.centres[:, 0] - 0.015) > 0.02)
    assert coverage.hidden == 0.0
    assert coverage.contents == pytest.approx(0.95)


def test_nothing_hides_under_a_ceiling_lower_than_the_thing() -> None:
    coverage = nothing_known().with_known(GRID.centres[:, 2] > 0.06)
    assert coverage.hidden == 0.0


def test_space_above_the_thing_does_not_matter() -> None:
    coverage = nothing_known().with_known(GRID.centres[:, 2] > 0.12)
    assert coverage.hidden == 1.0


def test_half_a_table_hides_about_half_of_the_places() -> None:
    coverage = nothing_known().with_known(GRID.centres[:, 1] > 0.0)
    assert coverage.contents == 0.5
    assert 0.45 < coverage.hidden < 0.5


def test_thing_larger_than_the_box_is_not_hidden_in_it() -> None:
    grid = Grid((0.05, 0.05, 0.3), 0.03)
    assert Coverage(grid, grid.window((0.12, 0.12, 0.1)), np.zeros(len(grid.centres), dtype=bool)).hidden == 0.0


def test_points_are_counted_in_the_voxels_they_lie_in() -> None:
    points = np.vstack([GRID.centres[7] + (0.014, -0.014, 0.0), GRID.centres[7], GRID.centres[8], (0.0, 0.0, -0.01)])
    inside = GRID.contains(points)
    assert inside.tolist() == [True, True, True, False]
    counts = GRID.count(points[inside])
    assert (counts[7], counts[8], counts.sum()) == (2, 1, 3)


@pytest.mark.parametrize(("kind", "theta"), [(CAN, 0.3), (CARTON, 0.0), (CARTON, 0.7), (CARTON, -2.0)])
def test_inside_of_a_thing_has_its_volume(kind: ObjectType, theta: float) -> None:
    fine = Grid((0.5, 0.5, 0.3), 0.01)
    inside = fine.inside(kind, (0.03, -0.05, theta), 0.0, 0.0)
    x, y, z = kind.size_m
    area = math.pi * x * x / 4 if kind.shape == "cylinder" else x * y
    assert inside.sum() * fine.step.prod() == pytest.approx(area * z, rel=0.12)
    assert fine.centres[inside].mean(axis=0) == pytest.approx((0.03, -0.05, z / 2), abs=0.005)


def test_turned_box_is_long_along_its_own_axis() -> None:
    inside = GRID.centres[GRID.inside(CARTON, (0.0, 0.0, math.pi / 2), 0.0, 0.0)]
    assert np.ptp(inside[:, 0]) > 0.2 > 0.05 > np.ptp(inside[:, 1])


def test_unknown_around_a_place_is_that_of_the_place() -> None:
    coverage = nothing_known().with_known(GRID.centres[:, 1] > 0.0)
    assert coverage.unknown_around(0.1, -0.3) == 1.0
    assert coverage.unknown_around(0.1, 0.3) == 0.0
    assert 0.0 < coverage.unknown_around(0.1, 0.0) < 1.0
    assert coverage.unknown_around(2.0, 0.0) == 0.0


def test_unknown_points_are_unknown_and_spread_evenly() -> None:
    coverage = nothing_known().with_known(GRID.centres[:, 1] > 0.0)
    points = coverage.unknown_points(64, also=NOWHERE)
    assert points.shape == (64, 3)
    assert points[:, 1].max() < 0.0
    octants = (points[:, 0] > 0.0) * 4 + (points[:, 1] > -0.225) * 2 + (points[:, 2] > 0.15)
    assert np.bincount(octants.astype(int), minlength=8) == pytest.approx(np.full(8, 8), abs=3)


def test_few_unknown_voxels_are_all_told() -> None:
    coverage = nothing_known().with_known(np.arange(len(GRID.centres)) >= 5)
    assert len({tuple(point) for point in coverage.unknown_points(64, also=NOWHERE).tolist()}) == 5
    assert coverage.with_known(~coverage.known).unknown_points(64, also=NOWHERE).shape == (0, 3)

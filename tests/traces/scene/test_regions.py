"""Cubes that stand for the unseen part of a region: together as large as it, and inside the region."""

import math

import numpy as np
import pytest

from skolem.traces.messages import RegionBelief
from skolem.traces.scene.regions import cubes

FACE_M, HEIGHT_M = (0.8, 1.2), 0.3
VOLUME_M3 = math.prod(FACE_M) * HEIGHT_M


def region(hidden: float, count: int) -> RegionBelief:
    points = np.random.default_rng(1).uniform((-400, -600, 0), (400, 600, 300), (count, 3)).astype(int).tolist()
    return RegionBelief(
        support="table1", height_m=HEIGHT_M, seen=0.3, hidden=hidden, unseen_mm=tuple((x, y, z) for x, y, z in points)
    )


@pytest.mark.parametrize(("hidden", "count"), [(1.0, 64), (0.15, 64), (0.01, 64), (0.3, 17)])
def test_their_volumes_add_up_to_what_may_hide_things(hidden: float, count: int) -> None:
    edge, centres = cubes(region(hidden, count), FACE_M)
    assert len(centres) == count
    assert count * edge**3 == pytest.approx(hidden * VOLUME_M3)


def test_where_nothing_can_hide_there_are_crumbs() -> None:
    edge, centres = cubes(region(0.0, 64), FACE_M)
    assert 0.0 < len(centres) * edge**3 < 0.001 * VOLUME_M3


def test_of_a_region_that_is_all_seen_nothing_is_drawn() -> None:
    assert cubes(region(0.0, 0), FACE_M)[1] == []


@pytest.mark.parametrize(("hidden", "count"), [(1.0, 64), (1.0, 1), (0.01, 64)])
def test_they_are_inside_the_region(hidden: float, count: int) -> None:
    edge, centres = cubes(region(hidden, count), FACE_M)
    off = np.abs(np.array(centres) - (0.0, 0.0, HEIGHT_M / 2.0)) + edge / 2.0
    assert (off <= np.array((*FACE_M, HEIGHT_M)) / 2.0 + 1e-9).all()

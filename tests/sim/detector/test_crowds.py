"""Crowds: many things of one height, whose tops are no table, and blocks of things that touch."""

import pytest
from kit.tabletop import CLEAR, RED, TABLE, TABLE_M, TYPES, Placed, seen_cloud

from benchmarks.detector import Tally, judge
from benchmarks.detector_crowds import NEAR_M, block, crowd, noise_times
from skolem.sim.detector.detect import detect

pytestmark = pytest.mark.physics


@pytest.mark.parametrize(
    ("kind", "count", "scale"), [("soda", 30, 1), ("soda", 18, 2), ("bottle", 24, 1), ("carton", 18, 2)]
)
def test_nearly_all_things_of_a_crowd_are_found_and_nothing_else(kind: str, count: int, scale: int) -> None:
    tally = Tally()
    judge(crowd(kind, count, 0, TYPES), TYPES, tally, noise_times(scale), NEAR_M)
    assert tally.found >= 0.95 * count
    assert tally.false <= 0.05 * count
    assert tally.right == tally.found


@pytest.mark.parametrize(("rows", "columns"), [(2, 2), (3, 4)])
def test_touching_cans_of_a_block_are_told_apart(rows: int, columns: int) -> None:
    tally = Tally()
    judge(block("soda", rows, columns, TYPES), TYPES, tally)
    assert (tally.found, tally.false) == (rows * columns, 0)


def test_the_tops_of_a_crowd_are_no_support() -> None:
    things: list[Placed] = [
        ("soda", (0.86 + 0.11 * i, -0.4 + 0.16 * j, TABLE_M, 0.0), RED) for i in range(5) for j in range(6)
    ]
    heights = [support.offset for support in detect(seen_cloud([TABLE, *things], CLEAR), TYPES, CLEAR).supports]
    assert heights == pytest.approx([TABLE_M, 0.0], abs=0.005)

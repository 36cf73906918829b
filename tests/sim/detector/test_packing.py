import numpy as np
import pytest
from numpy.typing import NDArray

from skolem.sim.detector.packing import packed
from skolem.traces.messages import ObjectType

STEP_M = 0.004
CAN = ObjectType(shape="cylinder", size_m=(0.066, 0.066, 0.115), graspable=True)
CARTON = ObjectType(shape="box", size_m=(0.06, 0.09, 0.14), graspable=True)


def top(kind: ObjectType, x: float, y: float) -> NDArray[np.float64]:
    """Return points of the top of a thing at a place, shape (n, 3)."""
    steps = np.arange(-0.06, 0.06, STEP_M) + STEP_M / 2.0
    u, v = np.array([(along, across) for along in steps for across in steps]).T
    half = np.array(kind.size_m[:2]) / 2.0
    inside = np.hypot(u, v) < half[0] if kind.shape == "cylinder" else (np.abs(u) < half[0]) & (np.abs(v) < half[1])
    return np.column_stack([u[inside] + x, v[inside] + y, np.full(int(inside.sum()), kind.size_m[2])])


def places_of(points: NDArray[np.float64], types: dict[str, ObjectType]) -> list[tuple[float, ...]]:
    area = np.full(len(points), STEP_M**2)
    found = [tuple(part.xy_theta[:2].tolist()) for part in packed(points[:, :2], points[:, 2], area, types)]
    return sorted(found, key=lambda place: (round(place[0] / 0.05), place[1]))


@pytest.mark.parametrize("columns", [2, 3, 4])
def test_cans_of_a_block_are_parted_where_they_stand(columns: int) -> None:
    centres = [(0.066 * i, 0.066 * j) for i in range(2) for j in range(columns)]
    found = places_of(np.concatenate([top(CAN, *centre) for centre in centres]), {"soda": CAN})
    assert np.array(found) == pytest.approx(np.array(sorted(centres)), abs=0.012)


def test_boxes_in_a_row_are_laid_along_it() -> None:
    centres = [(0.0, 0.09 * j) for j in range(3)]
    found = places_of(np.concatenate([top(CARTON, *centre) for centre in centres]), {"carton": CARTON})
    assert np.array(found) == pytest.approx(np.array(centres), abs=0.015)


def test_a_can_beside_a_box_is_parted_from_it() -> None:
    points = np.concatenate([top(CAN, 0.0, 0.0), top(CARTON, 0.063, 0.0)])
    area = np.full(len(points), STEP_M**2)
    parts = packed(points[:, :2], points[:, 2], area, {"carton": CARTON, "soda": CAN})
    tops = [set(points[part.mask, 2].tolist()) for part in parts]
    assert len(parts) == 2
    assert sorted(min(heights) for heights in tops) == [0.115, 0.14]


def test_one_thing_is_no_packing() -> None:
    points = top(CAN, 0.0, 0.0)
    assert packed(points[:, :2], points[:, 2], np.full(len(points), STEP_M**2), {"soda": CAN}) == []

"""Tables seen in part: how well their edges place them, and that the covariance says how well."""

import math
from functools import cache

import numpy as np
import pytest
from kit.tabletop import CLEAR, GREEN, RED, SHAKY, TABLE, TABLE_M, TYPES, Placed, looking, seen_cloud
from numpy.typing import NDArray

from skolem.sim.detector.detect import detect
from skolem.sim.space.pinhole import Frame
from skolem.traces.messages import Detection, NoiseModel, Pose2

VIEWS = 12
KINDS = {name: kind for name, kind in TYPES.items() if name != "low_table"}
EYE = (-0.1, 0.0, 1.65)
WELL_M, WELL_RAD = 0.01, math.radians(1.0)


@cache
def view(number: int) -> tuple[Frame, tuple[Placed, ...]]:
    """Return a look at a random place of a table at a random pose, with three things on it."""
    draws = np.random.Generator(np.random.PCG64(number))
    distance, bearing, theta = draws.uniform((0.75, -0.5, -math.pi), (1.8, 0.5, math.pi)).tolist()
    table = (distance * math.cos(bearing), distance * math.sin(bearing), theta)
    half = np.array(TYPES["table"].size_m[:2]) / 2.0 - 0.06
    spots = [on(table, draws.uniform(-half, half)) for _ in range(4)]
    things: list[Placed] = [("table", (table[0], table[1], 0.0, theta), RED)]
    for name, (x, y) in zip(("bottle", "carton", "soda"), spots[1:], strict=True):
        things.append((name, (x, y, TABLE_M, 0.0), GREEN))
    return looking(EYE, (*spots[0], TABLE_M)), tuple(things)


def on(table: Pose2, spot: NDArray[np.float64]) -> tuple[float, float]:
    c, s = math.cos(table[2]), math.sin(table[2])
    return (table[0] + c * float(spot[0]) - s * float(spot[1]), table[1] + s * float(spot[0]) + c * float(spot[1]))


def tables(number: int, noise: NoiseModel) -> tuple[Detection, ...]:
    frame, things = view(number)
    return detect(seen_cloud(list(things), noise, number, frame), KINDS, noise).tables


def error(detection: Detection, truth: Placed) -> NDArray[np.float64]:
    """Return the true pose in the frame of the detected one, headings modulo half a turn, shape (3,)."""
    x, y, _, theta = detection.base_T_object
    c, s = math.cos(theta), math.sin(theta)
    off = np.array([[c, s], [-s, c]]) @ np.subtract(truth[1][:2], (x, y))
    turn = truth[1][3] - theta
    return np.array([*off, turn - math.pi * round(turn / math.pi)])


def covariance(detection: Detection) -> NDArray[np.float64]:
    full = np.zeros((3, 3))
    full[np.triu_indices(3)] = detection.covariance
    return full + full.T - np.diag(np.diag(full))


@pytest.mark.physics
def test_a_table_seen_in_part_is_placed_to_a_centimetre_and_a_degree_where_its_edges_tell() -> None:
    found = 0
    for number in range(VIEWS):
        for detection in tables(number, CLEAR):
            told = np.sqrt(np.diag(covariance(detection))) < (WELL_M, WELL_M, WELL_RAD)
            off = np.abs(error(detection, view(number)[1][0]))
            assert (off[told] < np.array([WELL_M, WELL_M, WELL_RAD])[told]).all()
            found += int(told.all())
    assert found >= 0.9 * VIEWS


@pytest.mark.physics
def test_errors_of_tables_are_as_large_as_the_covariance_says() -> None:
    squares = []
    for number in range(VIEWS):
        for detection in tables(number, SHAKY):
            off = error(detection, view(number)[1][0])
            squares.append(float(off @ np.linalg.solve(covariance(detection), off)))
    assert 0.3 < np.mean(squares) / 3.0 < 1.6
    assert max(squares) < 20.0


@pytest.mark.physics
def test_a_look_says_the_same_of_a_table_twice() -> None:
    assert tables(0, SHAKY) == tables(0, SHAKY)


@pytest.mark.physics
def test_a_table_is_a_table_and_stands_on_the_floor() -> None:
    (table,) = tables(1, CLEAR)
    assert sorted(table.type_log_likelihood) == ["table"]
    assert table.base_T_object[2] == pytest.approx(0.0, abs=0.01)


@pytest.mark.physics
def test_where_only_the_border_of_the_image_ends_a_top_no_table_is_reported() -> None:
    seen = detect(seen_cloud([TABLE], CLEAR, frame=looking((0.9, 0.0, 1.3), (1.0, 0.0, TABLE_M))), KINDS, CLEAR)
    assert len(seen.supports) == 1
    assert seen.tables == ()


@pytest.mark.physics
def test_along_the_only_edges_that_show_the_place_of_a_table_is_unknown() -> None:
    frame = looking((-0.4, 0.0, 1.6), (1.0, 0.0, TABLE_M))
    row: list[Placed] = [("table", (1.1, k * 1.1, 0.0, 0.0), RED) for k in (-1, 0, 1)]  # as one, longer than the image
    long = {"table": TYPES["table"].model_copy(update={"size_m": (0.7, 3.3, TABLE_M)})}
    (table,) = detect(seen_cloud(row, CLEAR, frame=frame), long, CLEAR).tables
    across, along, turn = np.sqrt(np.diag(covariance(table))).tolist()
    assert table.base_T_object[0] == pytest.approx(1.1, abs=WELL_M)
    assert table.base_T_object[3] == pytest.approx(0.0, abs=WELL_RAD)
    assert across < WELL_M
    assert turn < WELL_RAD
    assert along > 0.3


@pytest.mark.physics
def test_two_tables_apart_are_two() -> None:
    frame = looking((-0.4, 0.0, 1.8), (1.0, 0.0, TABLE_M))
    things: list[Placed] = [("table", (1.1, y, 0.0, math.pi / 2.0), RED) for y in (-0.6, 0.6)]
    found = detect(seen_cloud(things, CLEAR, frame=frame), KINDS, CLEAR).tables
    places = sorted((table.base_T_object[:2] for table in found), key=lambda place: place[1])
    assert np.array(places) == pytest.approx(np.array([(1.1, -0.6), (1.1, 0.6)]), abs=0.02)


@pytest.mark.physics
def test_tables_of_different_height_are_told_apart() -> None:
    frame = looking((-0.3, -0.3, 1.5), (0.7, -0.5, 0.5))
    things: list[Placed] = [("table", (1.1, 0.0, 0.0, 0.0), RED), ("low_table", (0.45, -0.7, 0.0, 0.0), RED)]
    found = detect(seen_cloud(things, CLEAR, frame=frame), TYPES, CLEAR).tables
    at = {max(table.type_log_likelihood): table.base_T_object[:2] for table in found}
    assert at["table"] == pytest.approx((1.1, 0.0), abs=0.01)
    assert at["low_table"] == pytest.approx((0.45, -0.7), abs=0.01)

import math

import numpy as np
import pytest
from kit.tabletop import (
    BLUE,
    CLEAR,
    EXACT,
    GREEN,
    RED,
    SHAKY,
    TABLE,
    TABLE_M,
    TYPES,
    Placed,
    looking,
    picture,
    seen_cloud,
)
from numpy.typing import NDArray

from skolem.sim.detector.cloud import BORDER_PX
from skolem.sim.detector.detect import Seen, canonical_order, detect
from skolem.traces.messages import Detection, NoiseModel

NEAR_M = 0.004  # a detection this near a thing, without calibration error, is of that thing
SCENES = 10
LONE_M = 0.16  # between centres of things in the random scenes


def look(things: list[Placed], noise: NoiseModel = CLEAR, step: int = 0) -> Seen:
    return detect(seen_cloud(things, noise, step), TYPES, noise)


def type_of(detection: Detection) -> str:
    return max(detection.type_log_likelihood, key=lambda name: detection.type_log_likelihood[name])


def scene(number: int) -> list[Placed]:
    """Return a table with three random things apart from each other."""
    draws, things = np.random.Generator(np.random.PCG64(number)), [TABLE]
    while len(things) < 4:
        x, y, theta = draws.uniform((0.9, -0.4, -1.5), (1.35, 0.4, 1.5)).tolist()
        if all(math.hypot(x - other[1][0], y - other[1][1]) > LONE_M for other in things[1:]):
            name, hsv = ("bottle", "carton", "soda")[int(draws.integers(3))], (RED, GREEN, BLUE)[int(draws.integers(3))]
            things.append((name, (x, y, TABLE_M, theta), hsv))
    return things


def assert_is(detection: Detection, thing: Placed) -> None:
    assert type_of(detection) == thing[0]
    assert detection.base_T_object[:2] == pytest.approx(thing[1][:2], abs=NEAR_M)


def by_place(detections: tuple[Detection, ...]) -> list[Detection]:
    return sorted(detections, key=lambda detection: detection.base_T_object[1])


def covariance(detection: Detection) -> NDArray[np.float64]:
    full = np.zeros((3, 3))
    full[np.triu_indices(3)] = detection.covariance
    return full + full.T - np.diag(np.diag(full))


@pytest.mark.parametrize("number", range(SCENES))
def test_all_things_apart_are_found_typed_and_placed(number: int) -> None:
    things = scene(number)
    found = by_place(look(things, step=number).detections)
    assert len(found) == 3
    for detection, thing in zip(found, sorted(things[1:], key=lambda thing: thing[1][1]), strict=True):
        assert_is(detection, thing)


def test_errors_are_as_large_as_the_covariance_says() -> None:
    squares = []
    for number in range(SCENES):
        things = sorted(scene(number)[1:], key=lambda thing: thing[1][1])
        found = by_place(look([TABLE, *things], SHAKY, number).detections)
        for detection, (_, world_T_object, _) in zip(found, things, strict=True):
            x, y, _, theta = detection.base_T_object
            c, s = math.cos(theta), math.sin(theta)
            off = np.array([[c, s], [-s, c]]) @ np.subtract(world_T_object[:2], (x, y))
            squares.append(float(off @ np.linalg.solve(covariance(detection)[:2, :2], off)))
    assert 0.4 < np.mean(squares) / 2.0 < 1.8  # three errors of a look are nearly one: about ten independent ones


def test_a_mean_colour_has_the_hue_of_the_paint() -> None:
    (detection,) = look([TABLE, ("soda", (1.0, 0.1, TABLE_M, 0.0), BLUE)]).detections
    red, green, blue = detection.rgb
    assert blue > 3.0 * max(red, green)
    assert blue == pytest.approx(CLEAR.colour_gain * BLUE[2], abs=0.06)


def test_an_empty_table_shows_nothing() -> None:
    seen = look([TABLE])
    assert seen.detections == ()
    assert len(seen.supports) == 2


def test_legs_of_a_table_are_no_things_but_a_can_on_the_floor_is_one() -> None:
    frame = looking((0.0, -0.6, 1.5), (0.9, -0.7, 0.2))
    things: list[Placed] = [TABLE, ("soda", (0.9, -0.9, 0.0, 0.0), RED)]
    (detection,) = detect(seen_cloud(things, CLEAR, frame=frame), TYPES, CLEAR).detections
    assert_is(detection, things[1])
    assert detection.base_T_object[2] == pytest.approx(0.0, abs=NEAR_M)


def test_things_on_tables_of_different_height_are_found_on_each() -> None:
    frame = looking((-0.3, -0.3, 1.5), (0.7, -0.5, 0.5))
    things: list[Placed] = [
        TABLE,
        ("low_table", (0.45, -0.7, 0.0, 0.0), RED),
        ("soda", (0.5, -0.75, 0.45, 0.0), GREEN),
        ("bottle", (1.0, -0.2, TABLE_M, 0.0), RED),
    ]
    found = by_place(detect(seen_cloud(things, CLEAR, frame=frame), TYPES, CLEAR).detections)
    assert len(found) == 2
    assert_is(found[0], things[2])
    assert_is(found[1], things[3])


@pytest.mark.parametrize("y", np.arange(0.60, 0.76, 0.02).tolist())
def test_a_thing_is_reported_exactly_if_the_border_does_not_cut_it(y: float) -> None:
    frame = looking((0.0, 0.0, 1.45), (1.1, 0.3, 0.7))
    things: list[Placed] = [("table", (1.1, 0.5, 0.0, 0.0), RED), ("soda", (1.0, y, TABLE_M, 0.0), GREEN)]
    column = np.flatnonzero((picture(things, frame).body == 2).any(axis=0)).min()
    found = detect(seen_cloud(things, EXACT, frame=frame), TYPES, EXACT).detections
    assert len(found) == int(column >= BORDER_PX)


@pytest.mark.parametrize("bearing", [0.6, 1.2, 1.9, 2.5])
def test_things_a_finger_apart_are_two(bearing: float) -> None:
    apart = 0.066 + 0.012
    beside = (1.1 + apart * math.cos(bearing), apart * math.sin(bearing), TABLE_M, 0.0)
    things: list[Placed] = [TABLE, ("soda", (1.1, 0.0, TABLE_M, 0.0), RED), ("soda", beside, GREEN)]
    found = by_place(look(things).detections)
    assert len(found) == 2
    assert_is(found[0], things[1])
    assert_is(found[1], things[2])


def test_a_half_hidden_thing_is_placed_right_if_it_is_reported() -> None:
    things: list[Placed] = [
        TABLE,
        ("bottle", (0.9, 0.0, TABLE_M, 0.0), RED),
        ("soda", (1.2, 0.05, TABLE_M, 0.0), GREEN),
    ]
    green = [detection for detection in look(things).detections if detection.rgb[1] > detection.rgb[0]]
    assert len(green) == 1
    assert green[0].base_T_object[:2] == pytest.approx((1.2, 0.05), abs=0.01)


def test_a_leg_of_which_a_table_hides_the_upper_part_is_no_thing() -> None:
    frame = looking((-0.3, -0.3, 1.5), (0.7, -0.5, 0.5))
    assert detect(seen_cloud([TABLE], CLEAR, frame=frame), TYPES, CLEAR).detections == ()


def test_a_cylinder_is_reported_with_an_unknown_heading_and_a_box_with_a_known_one() -> None:
    things: list[Placed] = [
        TABLE,
        ("soda", (1.0, -0.2, TABLE_M, 0.9), RED),
        ("carton", (1.0, 0.2, TABLE_M, 0.9), RED),
    ]
    soda, carton = by_place(look(things).detections)
    assert math.sqrt(covariance(soda)[2, 2]) > 1.5
    assert math.sqrt(covariance(carton)[2, 2]) < 0.2
    assert carton.base_T_object[3] == pytest.approx(0.9, abs=0.03)


def test_only_graspable_types_are_reported() -> None:
    (detection,) = look([TABLE, ("soda", (1.0, 0.0, TABLE_M, 0.0), RED)], EXACT).detections
    assert sorted(detection.type_log_likelihood) == ["bottle", "carton", "soda"]


def test_the_order_of_detections_does_not_depend_on_how_they_come() -> None:
    found = list(look(scene(3)).detections)
    assert canonical_order(found) == canonical_order(found[::-1])

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from skolem.estimation.config import EstimatorConfig
from skolem.estimation.visibility import DepthImage, prob_visible, prob_visible_and_solid, shows_behind
from skolem.traces.messages import DepthView, ObjectType, Pose2, Pose4

CAN = ObjectType(shape="cylinder", size_m=(0.066, 0.066, 0.12), graspable=True)
ROWS, COLUMNS, FOVY = 60, 80, 0.796
FOCAL = ROWS / 2 / math.tan(FOVY / 2)
CAMERA_Z, FLOOR = 1.2, 0.6  # metres; things stand on a plane
KNOWN = np.diag([1e-6, 1e-6, 1.0])


def view(depth_m: NDArray[np.float64] | float, heading: float = 0.0) -> DepthView:
    """A level camera above the origin that sees `depth_m` at each pixel."""
    depth = np.broadcast_to(np.asarray(depth_m), (ROWS, COLUMNS))
    return DepthView(
        base_T_camera=(0.0, 0.0, CAMERA_Z, 0.0, 0.0, math.sin(heading / 2), math.cos(heading / 2)),
        fovy_rad=FOVY,
        columns=COLUMNS,
        rows=ROWS,
        depth_mm=tuple(round(1000 * d) for d in depth.ravel().tolist()),
    )


def visible(
    picture: DepthView, pose: Pose2 = (2.0, 0.0, 0.0), cov: NDArray[np.float64] = KNOWN, z: float = CAMERA_Z
) -> float:
    return prob_visible(DepthImage.of(picture), pose, cov, z, CAN, EstimatorConfig())


def solid(picture: DepthView, pose: Pose2 = (2.0, 0.0, 0.0), z: float = CAMERA_Z, explained: bool = False) -> float:
    image, config = DepthImage.of(picture), EstimatorConfig()
    return prob_visible_and_solid(image, pose, KNOWN, z, CAN, config, lambda ends: np.full(len(ends), explained))[1]


def test_object_before_a_far_wall_would_be_seen() -> None:
    assert visible(view(4.0)) == 1.0


def test_object_that_is_there_counts_as_in_sight() -> None:
    assert visible(view(2.0 - 0.033)) == 1.0


def test_object_behind_something_is_hidden() -> None:
    assert visible(view(1.5)) == 0.0


def test_object_of_which_a_little_is_covered_would_still_be_seen_but_not_half_of_one() -> None:
    column = np.arange(COLUMNS)
    sliver = np.where(column < COLUMNS / 2 - 0.5 * 0.033 / 2.0 * FOCAL - 1, 1.5, 4.0)
    half = np.where(column <= COLUMNS / 2, 1.5, 4.0)
    assert visible(view(np.tile(sliver, (ROWS, 1)))) == 1.0
    assert visible(view(np.tile(half, (ROWS, 1)))) == 0.0


@pytest.mark.parametrize("pose", [(-2.0, 0.0, 0.0), (2.0, 1.5, 0.0), (0.0, 2.0, 0.0)])
def test_object_beside_or_behind_the_camera_is_out_of_sight(pose: Pose2) -> None:
    assert visible(view(4.0), pose) == 0.0


def test_object_cut_by_the_border_is_not_reported() -> None:
    edge = 2.0 * (COLUMNS / 2) / FOCAL
    assert visible(view(4.0), (2.0, edge - 0.08, 0.0)) == 1.0
    assert visible(view(4.0), (2.0, edge, 0.0)) == 0.0


def test_object_too_far_away_is_not_reported() -> None:
    assert visible(view(4.4), (3.0, 0.0, 0.0)) == 0.0


def test_camera_turns_with_its_frame() -> None:
    assert visible(view(4.0, heading=math.pi / 2), (0.0, 2.0, 0.0)) == 1.0
    assert visible(view(4.0, heading=math.pi / 2), (2.0, 0.0, 0.0)) == 0.0


def test_rows_count_from_the_top() -> None:
    upper_half_blocked = np.where(np.arange(ROWS) < ROWS / 2 - 1, 1.5, 4.0)[:, None] * np.ones(COLUMNS)
    assert visible(view(upper_half_blocked), z=CAMERA_Z + 0.1) == 0.0
    assert visible(view(upper_half_blocked), z=CAMERA_Z - 0.3) == 1.0


def test_pixels_without_return_prove_nothing() -> None:
    assert visible(view(0.0)) == 0.0


def test_vague_object_is_partly_in_sight_at_the_border() -> None:
    """Its position is known to 10 cm across, and its mean is half way out of the picture."""
    edge = 2.0 * (COLUMNS / 2) / FOCAL
    vague = np.diag([1e-6, 0.01, 1.0])
    assert 0.1 < visible(view(4.0), (2.0, edge - 0.08, 0.0), vague) < 0.9
    turned = np.diag([0.01, 1e-6, 1.0])  # the same in the axes of an object that is turned by a quarter
    assert visible(view(4.0), (2.0, edge - 0.08, math.pi / 2), turned) == pytest.approx(
        visible(view(4.0), (2.0, edge - 0.08, 0.0), vague)
    )


def test_object_of_which_the_border_cuts_a_sliver_is_not_reported() -> None:
    edge = 2.0 * (COLUMNS / 2) / FOCAL
    assert visible(view(4.0), (2.0, edge - 0.012, 0.0)) == 0.0


def test_something_solid_is_where_the_readings_end_on_the_object() -> None:
    assert solid(view(2.0 - 0.033)) == 1.0
    assert solid(view(2.0 + 0.05)) == 1.0
    assert solid(view(2.3)) == solid(view(1.5)) == 0.0


def test_what_something_else_explains_is_not_the_object() -> None:
    assert solid(view(2.0 - 0.033), explained=True) == 0.0


def test_object_out_of_sight_is_not_shown() -> None:
    assert solid(view(2.0 - 0.033), (2.0, 1.5, 0.0)) == 0.0


def test_surface_under_an_object_is_not_the_object() -> None:
    height = CAMERA_Z - FLOOR
    down = (np.arange(ROWS) + 1 - ROWS / 2)[:, None] / FOCAL * np.ones(COLUMNS)
    floor = np.where(down > 0.15, height / np.maximum(down, 1e-3), 4.0)
    assert visible(view(floor), (1.6, 0.0, 0.0), z=FLOOR) == 1.0
    assert solid(view(floor), (1.6, 0.0, 0.0), z=FLOOR) == 0.0


def refuted(picture: DepthView, pose: Pose4 = (2.0, 0.0, CAMERA_Z, 0.0), kind: ObjectType = CAN) -> bool:
    return shows_behind(DepthImage.of(picture), pose, kind, EstimatorConfig())


def test_picture_of_what_is_behind_a_place_shows_that_nothing_stands_there() -> None:
    assert refuted(view(4.0))
    assert not refuted(view(2.0 - 0.033))
    assert not refuted(view(1.5))


def test_picture_that_does_not_reach_a_place_shows_nothing_of_it() -> None:
    assert not refuted(view(0.0))
    assert not refuted(view(4.0), (2.0, 1.5, CAMERA_Z, 0.0))


def test_picture_of_a_surface_shows_what_is_not_on_it_but_for_flat_things() -> None:
    down = (np.arange(ROWS) + 1 - ROWS / 2)[:, None] / FOCAL * np.ones(COLUMNS)
    floor = np.where(down > 0.15, (CAMERA_Z - FLOOR) / np.maximum(down, 1e-3), 4.0)
    flat = CAN.model_copy(update={"size_m": (0.066, 0.066, 0.03)})
    assert refuted(view(floor), (1.6, 0.0, FLOOR, 0.0))
    assert not refuted(view(floor), (1.6, 0.0, FLOOR, 0.0), flat)

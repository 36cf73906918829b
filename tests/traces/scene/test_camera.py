"""Detections in the picture: projected with the camera's own convention."""

import math

import numpy as np
import pytest

from skolem.sim.space.pinhole import FOVY_RAD, pixel_rays
from skolem.traces.messages import DepthView, Detection, ObjectType
from skolem.traces.scene.camera import label_points, outline, pixel
from skolem.traces.scene.shapes import placed

COLUMNS, ROWS = 40, 30
HALF = math.sin(math.pi / 8.0)
TURN = (0.0, HALF, 0.0, math.sqrt(1.0 - HALF * HALF))  # looks 45 degrees down
VIEW = DepthView(
    base_T_camera=(0.1, 0.2, 1.3, *TURN), fovy_rad=FOVY_RAD, columns=COLUMNS, rows=ROWS, depth_mm=(0,) * COLUMNS * ROWS
)


def test_a_point_on_a_pixels_ray_is_seen_in_that_pixel() -> None:
    rays = pixel_rays(COLUMNS, ROWS)
    for row, column in ((0, 0), (7, 31), (ROWS - 1, COLUMNS - 1)):
        x, y, z = (1.7 * value for value in rays[row, column])
        point = placed((0.1, 0.2, 1.3), TURN, (x, y, z))
        assert pixel(point, VIEW, (COLUMNS, ROWS)) == pytest.approx((column, row), abs=1e-6)


def test_an_outline_encloses_the_object_and_stays_in_the_picture() -> None:
    kind = ObjectType(shape="box", size_m=(0.1, 0.1, 0.2), graspable=True)
    found = Detection(
        base_T_object=(1.0, 0.2, 0.4, 0.3),
        covariance=(1e-4, 0.0, 0.0, 1e-4, 0.0, 1e-2),
        type_log_likelihood={"can": -2.0, "box": -0.1},
        rgb=(0.1, 0.8, 0.1),
        points=150,
    )
    size = (320, 240)
    left, top, right, bottom = outline(found, kind, VIEW, size)
    middle = pixel((1.0, 0.2, 0.5), VIEW, size)
    assert left < middle[0] < right
    assert top < middle[1] < bottom
    near = found.model_copy(update={"base_T_object": (0.7, 0.2, 0.9, 0.3)})
    assert np.all(np.array(outline(near, kind, VIEW, size)) <= [320, 240, 320, 240])


def test_no_label_covers_another_detection() -> None:
    """A can behind a carton: below the can is the carton."""
    can, carton, table = (148.0, 80.0, 170.0, 110.0), (152.0, 100.0, 174.0, 144.0), (2.0, 2.0, 318.0, 206.0)
    points = label_points([can, carton, table], ["can", "carton", "table"], (320, 240))
    for text, (x, top), own in zip(("can", "carton", "table"), points, (can, carton, table), strict=True):
        half = 2.5 * len(text)
        for box in {can, carton} - {own}:
            assert x + half < box[0] or box[2] < x - half or top + 15.0 < box[1] or box[3] < top, (text, box)


def test_labels_are_written_once_per_detection() -> None:
    assert label_points([], [], (320, 240)) == []

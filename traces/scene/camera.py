"""The camera in a rerun recording: its picture if recorded, its coarse depth, and the detections.

A detection is a box in the picture, labelled with its likeliest type, and a ball above its position in 3D.
"""

import itertools
import math
from collections.abc import Mapping, Sequence

import numpy as np
import rerun as rr
from foxglove_schemas_protobuf.CameraCalibration_pb2 import CameraCalibration
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage

from skolem.traces.messages import DepthView, Detection, ObjectType, Observation
from skolem.traces.messages.likeliest import likeliest
from skolem.traces.scene.layout import HEIGHT_PX, Rectangle, Seen, Wish, arrange, dots
from skolem.traces.scene.rows import Rows, When
from skolem.traces.scene.shapes import Xyz, point_on, rotated

PICTURE, DEPTH = "camera/picture", "camera/depth"
_BALL_M, _ABOVE_M = 0.012, 0.045
_YELLOW = (255, 220, 60)
_VIEW_PX = 390.0  # columns of the camera view in a window of 1600 x 1000 with this layout
_TEXT_PX = -1.0  # from the upper edge of a label to its point in the viewer
_SIDE_PX = 8.0  # assumed thickness of the side of a box
_SIDE_WORTH_PX, _THING_WORTH_PX = 60.0, 500.0  # worth of a piece of a side, and of a detected object: see Seen
_DEPTH_RANGE_MM = (500, 3500)


class Camera:
    """Draws each look.

    Attributes:
        pictures: Whether any picture has been recorded.
    """

    def __init__(self, rows: Rows, base_link: str) -> None:
        """Start without a look; detections are drawn in the frame of the robot's base."""
        self.pictures = False
        self._rows = rows
        self._size: tuple[int, int] | None = None
        rows.static("detections", rr.CoordinateFrame(base_link))

    def picture(self, message: CompressedImage, when: When) -> None:
        """Show a picture."""
        self.pictures = True
        self._rows.add(PICTURE, when, rr.EncodedImage(contents=message.data, media_type=f"image/{message.format}"))

    def calibrated(self, message: CameraCalibration) -> None:
        """Take in the size of the pictures."""
        self._size = message.width, message.height

    def observed(self, message: Observation, when: When, types: Mapping[str, ObjectType]) -> None:
        """Show the detections; in 3D they stay until the next observation of any kind."""
        likely = [(found, likeliest(found.type_log_likelihood)) for found in message.detections]
        seen = [(found, types[name]) for found, name in likely if name in types]
        tops = [point_on(found.base_T_object, (0.0, 0.0, kind.size_m[2] + _ABOVE_M)) for found, kind in seen]
        colours = [[round(255 * part) for part in found.rgb] for found, _ in seen]
        self._rows.add("detections", when, rr.Points3D(tops, radii=[_BALL_M] * len(tops), colors=colours))
        if message.view is None:
            return
        depth = np.array(message.view.depth_mm, np.uint16).reshape(message.view.rows, message.view.columns)
        self._rows.add(DEPTH, when, rr.DepthImage(depth, meter=1000.0, depth_range=_DEPTH_RANGE_MM))
        self._mark(DEPTH, when, message.view, seen, (message.view.columns, message.view.rows))
        if self._size is not None:
            self._mark(PICTURE, when, message.view, seen, self._size)

    def _mark(
        self, image: str, when: When, view: DepthView, seen: list[tuple[Detection, ObjectType]], size: tuple[int, int]
    ) -> None:
        """Draw boxes around detections in an image of `size` (columns, rows)."""
        boxes = [outline(found, kind, view, size) for found, kind in seen]
        marks = rr.Boxes2D(
            mins=[(left, top) for left, top, _, _ in boxes],
            sizes=[(right - left, bottom - top) for left, top, right, bottom in boxes],
            colors=[_YELLOW] * len(boxes),
        )
        self._rows.add(f"{image}/detections", when, marks)
        names = [likeliest(found.type_log_likelihood) for found, _ in seen]
        texts = rr.Points2D(
            label_points(boxes, names, size),
            radii=[0.0] * len(boxes),
            labels=names,
            colors=[_YELLOW] * len(boxes),
            show_labels=True,
        )
        self._rows.add(f"{image}/labels", when, texts)


def outline(found: Detection, kind: ObjectType, view: DepthView, size: tuple[int, int]) -> Rectangle:
    """Return left, top, right and bottom of a detected object in an image of (columns, rows), in pixels."""
    x, y, z = kind.size_m
    corners = itertools.product((-x / 2.0, x / 2.0), (-y / 2.0, y / 2.0), (0.0, z))
    pixels = [pixel(point_on(found.base_T_object, corner), view, size) for corner in corners]
    columns, rows = ([min(max(0.0, at[axis]), size[axis]) for at in pixels] for axis in (0, 1))
    return min(columns), min(rows), max(columns), max(rows)


def label_points(boxes: Sequence[Rectangle], texts: Sequence[str], size: tuple[int, int]) -> list[tuple[float, float]]:
    """Return the points below which the viewer writes each box's text, in an image of (columns, rows).

    A text stands below its box unless it would cover another one; the largest boxes come last.
    """
    scale = size[0] / _VIEW_PX
    seen = [side for box in boxes for side in _sides(box, _SIDE_PX * scale)]
    order = sorted(range(len(boxes)), key=lambda i: (_area(boxes[i]), i))
    half = HEIGHT_PX / 2.0 * scale
    wishes = [Wish(texts[i], (((boxes[i][0] + boxes[i][2]) / 2.0, boxes[i][3] + 1.5 * half),)) for i in order]
    seen += [(*box, _THING_WORTH_PX) for box in boxes if not any(_holds(box, other) for other in boxes)]
    middles = arrange(wishes, seen, size, scale)
    placed = dict(zip(order, middles, strict=True))
    return [(placed[i][0], placed[i][1] - half + _TEXT_PX * scale) for i in range(len(boxes))]


def _sides(box: Rectangle, thick: float) -> list[Seen]:
    left, top, right, bottom = box
    corners = [np.array(corner) for corner in ((left, top), (right, top), (right, bottom), (left, bottom))]
    return [dot for i in range(4) for dot in dots(corners[i - 1], corners[i], thick, _SIDE_WORTH_PX)]


def _holds(box: Rectangle, other: Rectangle) -> bool:
    """Return whether `box` contains the other box."""
    return box != other and all(box[i] <= other[i] and other[i + 2] <= box[i + 2] for i in (0, 1))


def _area(box: Rectangle) -> float:
    return (box[2] - box[0]) * (box[3] - box[1])


def pixel(point_base: Xyz, view: DepthView, size: tuple[int, int]) -> tuple[float, float]:
    """Return the column and row at which a point before the camera is seen in an image of (columns, rows)."""
    x, y, z, qx, qy, qz, qw = view.base_T_camera
    away = point_base[0] - x, point_base[1] - y, point_base[2] - z
    forward, left, up = rotated((-qx, -qy, -qz, qw), away)
    columns, rows = size
    f = rows / 2.0 / math.tan(view.fovy_rad / 2.0)
    return columns / 2.0 - f * left / forward, rows / 2.0 - 1.0 - f * up / forward

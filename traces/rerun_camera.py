"""What the camera saw in a rerun recording: its picture if recorded, its coarse depth always, and the detections.

A detection is a box in the picture, labelled with the type it most looks like, and a ball above the place in 3D.
"""

import itertools
import math
from collections.abc import Mapping

import numpy as np
import rerun as rr
from foxglove_schemas_protobuf.CameraCalibration_pb2 import CameraCalibration
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage

from skolem.traces.messages import DepthView, Detection, ObjectType, Observation
from skolem.traces.rerun_rows import Rows, When
from skolem.traces.rerun_shapes import Xyz, point_on, rotated

PICTURE, DEPTH = "camera/picture", "camera/depth"
_BALL_M, _ABOVE_M = 0.012, 0.045
_DEPTH_RANGE_MM = (500, 3500)


class Camera:
    """Draws each look.

    Attributes:
        pictures: Whether any picture has been recorded.
    """

    def __init__(self, rows: Rows, base_link: str) -> None:
        """Begin without a look; detections are drawn in the frame of the robot's base."""
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
        """Show what was detected; detections in 3D stay until the next observation, of whatever kind."""
        seen = [(found, types[likely(found)]) for found in message.detections if likely(found) in types]
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
        """Draw boxes around detections in an image of that size (columns, rows)."""
        boxes = [outline(found, kind, view, size) for found, kind in seen]
        marks = rr.Boxes2D(
            mins=[(left, top) for left, top, _, _ in boxes],
            sizes=[(right - left, bottom - top) for left, top, right, bottom in boxes],
            labels=[likely(found) for found, _ in seen],
            colors=[[255, 220, 60]] * len(boxes),
            show_labels=True,
        )
        self._rows.add(f"{image}/detections", when, marks)


def likely(found: Detection) -> str:
    """Return the type a detection most looks like, of equally likely ones the first by name."""
    scores = found.type_log_likelihood
    return max(sorted(scores), key=scores.__getitem__)


def outline(
    found: Detection, kind: ObjectType, view: DepthView, size: tuple[int, int]
) -> tuple[float, float, float, float]:
    """Return left, top, right and bottom of what an image of (columns, rows) shows of a detected object, in pixels."""
    x, y, z = kind.size_m
    corners = itertools.product((-x / 2.0, x / 2.0), (-y / 2.0, y / 2.0), (0.0, z))
    pixels = [pixel(point_on(found.base_T_object, corner), view, size) for corner in corners]
    columns, rows = ([min(max(0.0, at[axis]), size[axis]) for at in pixels] for axis in (0, 1))
    return min(columns), min(rows), max(columns), max(rows)


def pixel(point_base: Xyz, view: DepthView, size: tuple[int, int]) -> tuple[float, float]:
    """Return the column and row at which a point before the camera is seen in an image of (columns, rows)."""
    x, y, z, qx, qy, qz, qw = view.base_T_camera
    away = point_base[0] - x, point_base[1] - y, point_base[2] - z
    forward, left, up = rotated((-qx, -qy, -qz, qw), away)
    columns, rows = size
    f = rows / 2.0 / math.tan(view.fovy_rad / 2.0)
    return columns / 2.0 - f * left / forward, rows / 2.0 - 1.0 - f * up / forward

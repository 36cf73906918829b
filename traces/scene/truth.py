"""The true objects in a rerun recording: solid shapes in their true colours."""

import itertools
from collections.abc import Iterator, Mapping

from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms

from skolem.traces.messages import ObjectType, TrueObject, TrueState
from skolem.traces.messages.poses import quaternion_xyzw
from skolem.traces.scene.rows import Rows, When
from skolem.traces.scene.shapes import WOOD, Shapes, Xyz, Xyzw, placed, rgba

PREFIX = "truth/"
_SAME_M = 1e-4  # smaller moves are not drawn


class Truth:
    """Draws the true objects, each when it moves."""

    def __init__(self, rows: Rows) -> None:
        """Start without objects."""
        self._shapes = Shapes(rows)
        self._objects: dict[str, TrueObject] = {}
        self._last: dict[str, tuple[float, float, float, float, float, float, float]] = {}

    def things(self, types: Mapping[str, ObjectType]) -> list[list[Xyz]]:
        """Return the corners of each object but the tables, world frame [m]."""
        kinds = {name: types[item.type] for name, item in self._objects.items()}
        return [
            [placed((x, y, z), (qx, qy, qz, qw), corner) for corner in _corners(kinds[name])]
            for name, (x, y, z, qx, qy, qz, qw) in self._last.items()
            if kinds[name].shape != "table"
        ]

    def state(self, message: TrueState, when: When, types: Mapping[str, ObjectType]) -> None:
        """Take in the true poses of all objects."""
        for item in message.objects:
            self._objects[item.id] = item
            x, y, z, theta = item.world_T_object
            self._draw(item.id, when, types, (x, y, z), quaternion_xyzw(theta))

    def moved(self, message: FrameTransforms, when: When, types: Mapping[str, ObjectType]) -> None:
        """Take in the frames of moving objects."""
        for frame in message.transforms:
            name = frame.child_frame_id.removeprefix(PREFIX)
            if name != frame.child_frame_id and name in self._objects:
                self._draw(name, when, types, *pose_of(frame))

    def _draw(self, name: str, when: When, types: Mapping[str, ObjectType], position: Xyz, turn: Xyzw) -> None:
        now, before = (*position, *turn), self._last.get(name)
        if before is not None and max(abs(a - b) for a, b in zip(now, before, strict=True)) < _SAME_M:
            return
        self._last[name] = now
        item = self._objects[name]
        kind = types.get(item.type)
        if kind is None:  # a recovered trace may have lost the description of a type
            return
        colour = rgba(WOOD if kind.shape == "table" else item.hsv)
        self._shapes.draw(f"{PREFIX}{name}", when, kind, position, turn, colour, "solid")


def _corners(kind: ObjectType) -> Iterator[Xyz]:
    """Return the corners of the box around an object, in its frame."""
    x, y, z = kind.size_m
    return itertools.product((-x / 2.0, x / 2.0), (-y / 2.0, y / 2.0), (0.0, z))


def pose_of(frame: FrameTransform) -> tuple[Xyz, Xyzw]:
    """Return position [m] and quaternion xyzw of a frame."""
    t, r = frame.translation, frame.rotation
    return (t.x, t.y, t.z), (r.x, r.y, r.z, r.w)

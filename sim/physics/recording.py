"""Protobuf messages of joints, frames and pictures for a trace, as pure functions of the tick and the values."""

import struct
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from foxglove_schemas_protobuf.CameraCalibration_pb2 import CameraCalibration
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.JointState_pb2 import JointState
from foxglove_schemas_protobuf.JointStates_pb2 import JointStates
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.RawImage_pb2 import RawImage
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3
from google.protobuf.timestamp_pb2 import Timestamp
from numpy.typing import NDArray

from skolem.sim.space.pinhole import focal_px
from skolem.traces.messages import TICKS_PER_SECOND
from skolem.traces.messages.poses import Quaternion as Xyzw, Vector3 as Xyz

WORLD_FRAME, BASE_FRAME, CAMERA_FRAME, TRUTH_PREFIX = "world", "base_footprint", "camera", "truth/"
_NANOSECONDS = 1_000_000_000
_PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_PNG_LEVEL = 6  # of zlib; fixed, so that equal pictures give equal bytes


@dataclass(frozen=True, slots=True)
class NamedPose:
    """The pose of a frame in the world: position [m] and quaternion xyzw."""

    child: str
    position: Xyz
    quaternion: Xyzw


def timestamp(tick: int) -> Timestamp:
    """Return the simulated time of a tick."""
    seconds, rest = divmod(tick, TICKS_PER_SECOND)
    return Timestamp(seconds=seconds, nanos=rest * _NANOSECONDS // TICKS_PER_SECOND)


def joint_states(tick: int, names: Sequence[str], positions: Sequence[float]) -> JointStates:
    """Return joint values [rad or m] by name."""
    joints = [JointState(name=name, position=value) for name, value in zip(names, positions, strict=True)]
    return JointStates(timestamp=timestamp(tick), joints=joints)


def transforms(tick: int, frames: Iterable[NamedPose]) -> FrameTransforms:
    """Return the message of frames' poses in the world."""
    return FrameTransforms(transforms=[_transform(tick, frame) for frame in frames])


def _transform(tick: int, frame: NamedPose) -> FrameTransform:
    (x, y, z), (qx, qy, qz, qw) = frame.position, frame.quaternion
    return FrameTransform(
        timestamp=timestamp(tick),
        parent_frame_id=WORLD_FRAME,
        child_frame_id=frame.child,
        translation=Vector3(x=x, y=y, z=z),
        rotation=Quaternion(x=qx, y=qy, z=qz, w=qw),
    )


def colour_image(tick: int, rgb: NDArray[np.uint8]) -> CompressedImage:
    """Return a picture of shape (rows, columns, 3) as PNG."""
    return CompressedImage(timestamp=timestamp(tick), frame_id=CAMERA_FRAME, format="png", data=png(rgb))


def depth_image(tick: int, depth: NDArray[np.float64]) -> RawImage:
    """Return a depth image of shape (rows, columns), metres, as 16-bit millimetres; NaN becomes 0."""
    rows, columns = depth.shape
    millimetres = np.round(1000.0 * np.nan_to_num(depth)).astype("<u2")
    return RawImage(
        timestamp=timestamp(tick),
        frame_id=CAMERA_FRAME,
        width=columns,
        height=rows,
        encoding="16UC1",
        step=2 * columns,
        data=millimetres.tobytes(),
    )


def calibration(tick: int, columns: int, rows: int) -> CameraCalibration:
    """Return the pinhole model of the camera, in the optical convention: x right, y down, z forward.

    The centre is at column columns / 2 and row rows / 2 - 1, by the renderer's convention without half pixels.
    """
    f, cx, cy = focal_px(rows), columns / 2.0, rows / 2.0 - 1.0
    return CameraCalibration(
        timestamp=timestamp(tick),
        frame_id=CAMERA_FRAME,
        width=columns,
        height=rows,
        K=[f, 0.0, cx, 0.0, f, cy, 0.0, 0.0, 1.0],
        R=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        P=[f, 0.0, cx, 0.0, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
    )


def png(rgb: NDArray[np.uint8]) -> bytes:
    """Return a picture of shape (rows, columns, 3) as the bytes of a PNG file: 8-bit RGB, unfiltered lines."""
    rows, columns, _ = rgb.shape
    lines = np.zeros((rows, 1 + 3 * columns), dtype=np.uint8)  # each line starts with filter type 0
    lines[:, 1:] = rgb.reshape(rows, 3 * columns)
    header = struct.pack(">IIBBBBB", columns, rows, 8, 2, 0, 0, 0)
    data = zlib.compress(lines.tobytes(), _PNG_LEVEL)
    return _PNG_SIGNATURE + _chunk(b"IHDR", header) + _chunk(b"IDAT", data) + _chunk(b"IEND", b"")


def _chunk(kind: bytes, data: bytes) -> bytes:
    """Return one chunk of a PNG file: length, kind, data, checksum."""
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

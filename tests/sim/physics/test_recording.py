import struct
import zlib

import numpy as np
import pytest

from skolem.sim.physics.recording import NamedPose, calibration, depth_image, joint_states, png, timestamp, transforms
from skolem.sim.space.pinhole import pixel_rays


def decoded(data: bytes) -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
    """Read back a PNG of one IDAT chunk and unfiltered lines, checking every checksum."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    chunks, at = {}, 8
    while at < len(data):
        (size,) = struct.unpack_from(">I", data, at)
        kind, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + size]
        assert struct.unpack_from(">I", data, at + 8 + size)[0] == zlib.crc32(kind + body)
        chunks[kind], at = body, at + 12 + size
    columns, rows = struct.unpack_from(">II", chunks[b"IHDR"])
    lines = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(rows, 1 + 3 * columns)
    assert not lines[:, 0].any()
    return lines[:, 1:].reshape(rows, columns, 3)


def test_png_reads_back_as_the_picture() -> None:
    rgb = np.random.Generator(np.random.PCG64(0)).integers(0, 256, (12, 17, 3)).astype(np.uint8)
    assert np.array_equal(decoded(png(rgb)), rgb)


@pytest.mark.parametrize(("tick", "seconds", "nanos"), [(0, 0, 0), (240, 1, 0), (361, 1, 504_166_666)])
def test_time_is_counted_in_ticks(tick: int, seconds: int, nanos: int) -> None:
    stamp = timestamp(tick)
    assert (stamp.seconds, stamp.nanos) == (seconds, nanos)


def test_depth_is_recorded_in_millimetres_with_zero_for_nothing() -> None:
    image = depth_image(0, np.array([[1.2344, np.nan, 4.5]]))
    assert (image.encoding, image.width, image.height, image.step) == ("16UC1", 3, 1, 6)
    assert np.frombuffer(image.data, "<u2").tolist() == [1234, 0, 4500]


def test_calibration_projects_a_ray_to_its_pixel() -> None:
    matrix = np.reshape(calibration(0, 320, 240).K, (3, 3))
    ray = pixel_rays(320, 240)[100, 250]
    optical = np.array([-ray[1], -ray[2], 1.0])  # x right, y down, z forward
    assert matrix @ optical == pytest.approx([250.0, 100.0, 1.0])


def test_joints_and_frames_keep_names_and_values() -> None:
    joints = joint_states(24, ["a", "b"], [0.5, -1.0]).joints
    frame = transforms(24, [NamedPose("truth/can", (1.0, 2.0, 3.0), (0.0, 0.0, 1.0, 0.0))]).transforms[0]
    assert [(joint.name, joint.position) for joint in joints] == [("a", 0.5), ("b", -1.0)]
    assert (frame.parent_frame_id, frame.child_frame_id, frame.translation.y, frame.rotation.z) == (
        "world",
        "truth/can",
        2.0,
        1.0,
    )

"""Conversion of a depth image to coloured points in the base frame and to a coarse depth view."""

from dataclasses import dataclass

import numpy as np
import scipy  # loads a part of itself when it is used
from numpy.typing import NDArray

from skolem.sim.space.pinhole import FOVY_RAD, Frame, pixel_rays
from skolem.sim.truth.noise import Extrinsics
from skolem.traces.messages import DepthView

VIEW_STRIDE = 4  # 80 x 60: at 1.2 m a pixel is 1.7 cm wide, half a voxel of the regions that are searched
BORDER_PX = 3
ABOVE_PX = 4  # the edge of a nearer object may have lost a pixel or two
NEARER_M = 0.05


@dataclass(frozen=True, slots=True)
class Cloud:
    """A cloud of coloured points where the robot believes them to be.

    Attributes:
        points_base: Shape (n, 3), metres, base frame.
        rgb: Shape (n, 3), each 0..1.
        at_border: Shape (n,), whether the pixel lies at the border of the image.
        under_nearer: Shape (n,), whether something nearer just above the pixel may hide more of its surface.
        pixel: Row and column of each point in the image, shape (n, 2).
        camera_base: Shape (3,), where the robot believes its camera to be, metres, base frame.
    """

    points_base: NDArray[np.float64]
    rgb: NDArray[np.float64]
    at_border: NDArray[np.bool_]
    under_nearer: NDArray[np.bool_]
    pixel: NDArray[np.int64]
    camera_base: NDArray[np.float64]

    def only(self, chosen: NDArray[np.bool_]) -> "Cloud":
        """Return the points that a mask of shape (n,) selects."""
        return Cloud(
            self.points_base[chosen],
            self.rgb[chosen],
            self.at_border[chosen],
            self.under_nearer[chosen],
            self.pixel[chosen],
            self.camera_base,
        )


def cloud_from_depth(
    depth: NDArray[np.float64], rgb: NDArray[np.float64], base_T_camera: Frame, error: Extrinsics
) -> Cloud:
    """Return the coloured points of an image, displaced by the camera's calibration error.

    Args:
        depth: Distance along the camera's axis, shape (rows, columns), metres; NaN where there is no reading.
        rgb: Shape (rows, columns, 3), each 0..1.
        base_T_camera: From the robot's encoders.
        error: Calibration error of this look.
    """
    rows, columns = depth.shape
    camera = (pixel_rays(columns, rows) * depth[..., None]).reshape(-1, 3) @ error.turn.T + error.shift
    points_base = camera @ base_T_camera.axes.T + base_T_camera.origin
    border = np.ones((rows, columns), dtype=bool)
    border[BORDER_PX:-BORDER_PX, BORDER_PX:-BORDER_PX] = False
    under = _under_nearer(depth).ravel()
    pixel = np.indices((rows, columns), dtype=np.int64).reshape(2, -1).T
    cloud = Cloud(points_base, rgb.reshape(-1, 3), border.ravel(), under, pixel, base_T_camera.origin)
    return cloud.only(np.isfinite(depth).ravel())


def _under_nearer(depth: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return the mask of readings with a clearly nearer one among the few pixels above, shape (rows, columns)."""
    nearest = np.full(depth.shape, np.inf)
    for up in range(1, ABOVE_PX + 1):
        nearest[up:] = np.fmin(nearest[up:], depth[:-up])
    return np.asarray(nearest < depth - NEARER_M)


def without_own_body(cloud: Cloud, segments_base: NDArray[np.float64], radius_m: float) -> Cloud:
    """Return the cloud without the points near the robot's own limbs, which it knows from its encoders.

    Args:
        cloud: Points in the base frame.
        segments_base: Axes of the limbs, shape (k, 2, 3), metres, base frame.
        radius_m: Greatest distance of a limb's points from its axis.
    """
    keep = np.ones(len(cloud.points_base), dtype=bool)
    for start, end in segments_base:
        along = end - start
        offset = cloud.points_base - start
        share = np.clip(offset @ along / max(float(along @ along), 1e-12), 0.0, 1.0)
        keep &= np.linalg.norm(offset - share[:, None] * along, axis=1) > radius_m
    return cloud.only(keep)


def misplaced(base_T_camera: Frame, error: Extrinsics) -> Frame:
    """Return base_T_camera as a camera with that calibration error believes it."""
    return Frame(base_T_camera.origin + base_T_camera.axes @ error.shift, base_T_camera.axes @ error.turn)


def depth_view(depth: NDArray[np.float64], base_T_camera: Frame) -> DepthView:
    """Return every fourth reading of a depth image: those on the rays that `DepthView` defines.

    The readings are samples, not minima or means of blocks, since a reading belongs to its ray.
    """
    sampled = depth[VIEW_STRIDE - 1 :: VIEW_STRIDE, ::VIEW_STRIDE]
    rows, columns = sampled.shape
    quaternion = scipy.spatial.transform.Rotation.from_matrix(base_T_camera.axes).as_quat()
    x, y, z, qx, qy, qz, qw = (float(value) for value in (*base_T_camera.origin, *quaternion))
    return DepthView(
        base_T_camera=(x, y, z, qx, qy, qz, qw),
        fovy_rad=FOVY_RAD,
        columns=columns,
        rows=rows,
        depth_mm=tuple(int(mm) for mm in np.round(1000.0 * np.nan_to_num(sampled)).ravel()),
    )

"""Patches: the connected parts of a plane in a point cloud that are large enough to stand things on.

A plane through a cloud may hold a table, and it may hold the tops of many things of one height. A patch is connected in
itself and has no holes: a ray that crosses it and goes on to something below shows that nothing is there. If such rays
are seen all around a patch, it is as large as a known table. What stands on a patch hides parts of it; pieces that only
such a shadow parts belong to one patch.
"""

from dataclasses import dataclass

import numpy as np
import scipy  # loads a part of itself when it is used
from numpy.typing import NDArray

from skolem.sim.truth.noise import axial_sd

MIN_AREA_M2 = 0.05  # a patch of 22 cm square; the top of a graspable object is smaller
STEP_M = 0.03  # a point this far above or below the plane is not of it
CELL_STEPS, CELL_SDS = 2.0, 3.0  # width of a cell: steps between pixels on the plane, and sds of depth along it
FAR_SHARE = 90.0  # percentile of the points' distances for which cells are wide enough
MIN_CELL_M, MAX_CELL_M = 0.015, 0.06
HOLE_M = 0.12  # holes at most this wide between tops are seen as holes, wider ones part them
MAX_THROUGH = 0.02  # greatest share of rays through a patch, relative to its points
MIN_RAY_SLOPE = 0.1  # a flatter ray gives no horizontal area
RING_CELLS, ENDS = (1, 3), 0.8  # a patch ends where rays go through most cells of a ring around it
WHOLE_SHARE = 0.5  # of the area of the smallest known table: a patch of which every end is seen is larger
TOUCHING = np.ones((3, 3), dtype=bool)

Mask = NDArray[np.bool_]
Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Plane:
    """A plane z = a x + b y + c through a cloud, in the base frame.

    Attributes:
        points: All points of the cloud, shape (n, 3), metres.
        camera: Position of the camera, shape (3,), metres.
        near: Mask of the points that lie on the plane, shape (n,).
        slope: (a, b, c).
        area: Horizontal area that each point stands for, shape (n,), square metres.
        focal_px: Focal length of the depth image in pixels.
        depth_sd_scale: Factor on the standard deviation of depth readings.
        table_m2: Area of the smallest known table.
    """

    points: Array
    camera: Array
    near: Mask
    slope: Array
    area: Array
    focal_px: float
    depth_sd_scale: float
    table_m2: float


def patches(plane: Plane) -> list[Mask]:
    """Return the masks, shape (n,), of the points of each patch of a plane, in the order of their cells."""
    if plane.area[plane.near].sum() < MIN_AREA_M2:
        return []
    grid = _Grid.over(plane)
    above = plane.points[:, 2] - plane.points[:, :2] @ plane.slope[:2] - plane.slope[2]
    on = grid.count(plane.points[plane.near, :2])
    through = grid.count(_crossings(plane, above, above < -STEP_M))
    shadow = grid.count(_crossings(plane, above, above > STEP_M))
    piece, number = scipy.ndimage.label(on > 0, structure=TOUCHING)
    of_point = piece[grid.cells(plane.points[plane.near, :2])]
    area = np.bincount(of_point, weights=plane.area[plane.near], minlength=number + 1)
    large = [index for index in range(1, number + 1) if area[index] >= MIN_AREA_M2]
    whole = [index for index in large if not _has_holes(piece == index, on, through, grid.cell_m)]
    small = WHOLE_SHARE * plane.table_m2
    whole = [index for index in whole if area[index] >= small or not _ends_in_view(piece == index, through)]
    joined, _ = scipy.ndimage.label((on > 0) | (shadow > 0), structure=TOUCHING)
    kept = np.unique(joined[np.isin(piece, whole)])
    masks = []
    for index in kept:
        mask = np.zeros(len(plane.points), dtype=bool)
        mask[plane.near] = joined[grid.cells(plane.points[plane.near, :2])] == index
        masks.append(mask)
    return masks


def _has_holes(piece: Mask, on: NDArray[np.int64], through: NDArray[np.int64], cell_m: float) -> bool:
    """Return whether rays go through a connected piece, given the numbers of points and of such rays in each cell."""
    reach = max(1, round(HOLE_M / 2.0 / cell_m))
    room = np.pad(piece, reach + 1)  # a closing needs room at the border
    filled = scipy.ndimage.binary_closing(room, structure=TOUCHING, iterations=reach)
    inner = scipy.ndimage.binary_erosion(filled, structure=TOUCHING)[reach + 1 : -reach - 1, reach + 1 : -reach - 1]
    return bool(through[inner].sum() > MAX_THROUGH * on[piece].sum())


def _ends_in_view(piece: Mask, through: NDArray[np.int64]) -> bool:
    """Return whether rays go past a connected piece on all sides, so that it is no larger than what is seen of it."""
    width = RING_CELLS[1]
    room = np.pad(piece, width)
    near, far = (scipy.ndimage.binary_dilation(room, structure=TOUCHING, iterations=cells) for cells in RING_CELLS)
    return bool((np.pad(through, width)[far & ~near] > 0).mean() >= ENDS)


def _crossings(plane: Plane, above: Array, chosen: Mask) -> Array:
    """Return the crossings of the chosen points' rays with the plane, shape (m, 2); rays to points above go on."""
    eye = float(plane.camera[2] - plane.camera[:2] @ plane.slope[:2] - plane.slope[2])
    share = eye / np.maximum(eye - above[chosen], STEP_M)
    return np.asarray(plane.camera[:2] + share[:, None] * (plane.points[chosen, :2] - plane.camera[:2]))


@dataclass(frozen=True, slots=True)
class _Grid:
    """Square cells over the points of a plane.

    Attributes:
        origin: Corner with the least coordinates, shape (2,), metres.
        cell_m: Width of a cell.
        shape: Number of cells along x and y.
    """

    origin: Array
    cell_m: float
    shape: tuple[int, int]

    @classmethod
    def over(cls, plane: Plane) -> "_Grid":
        """Return cells wide enough that neighbouring pixels on the plane lie in touching ones, whatever their noise."""
        points = plane.points[plane.near]
        ray = points - plane.camera
        distance = np.linalg.norm(ray, axis=1)
        far = float(np.percentile(distance, FAR_SHARE))
        slope = max(float(np.median(-ray[:, 2] / distance)), MIN_RAY_SLOPE)
        noise = plane.depth_sd_scale * float(axial_sd(np.array(far)))
        cell = float(np.clip(CELL_STEPS * far / plane.focal_px / slope + CELL_SDS * noise, MIN_CELL_M, MAX_CELL_M))
        room = (RING_CELLS[1] + 1) * cell
        low, high = points[:, :2].min(axis=0) - room, points[:, :2].max(axis=0) + room
        rows, columns = (int(value) + 1 for value in (high - low) / cell)
        return cls(low, cell, (rows, columns))

    def cells(self, places: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the row and column of the cell of each place, shape (m,) each; the places are on the grid."""
        rows, columns = np.floor((places - self.origin) / self.cell_m).astype(np.int64).T
        return rows, columns

    def count(self, places: Array) -> NDArray[np.int64]:
        """Return the number of places, shape (m, 2), in each cell; places beside the grid do not count."""
        rows, columns = self.cells(places)
        inside = (rows >= 0) & (rows < self.shape[0]) & (columns >= 0) & (columns < self.shape[1])
        flat = rows[inside] * self.shape[1] + columns[inside]
        return np.bincount(flat, minlength=self.shape[0] * self.shape[1]).reshape(self.shape)

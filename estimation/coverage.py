"""The known part of a box of air, in voxels, and the places in it where an object could still be hidden.

The frame is that of the face on which the box stands: x and y from its centre, z from the face up, metres.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from skolem.traces.messages import ObjectType, Pose2

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


class Grid:
    """A box cut into voxels.

    Attributes:
        shape: Number of voxels along x, y, z.
        step: Edges of a voxel, metres, shape (3,).
        centres: Centres of the voxels, shape (n, 3); the last axis of `shape` varies fastest.
        spread: Indices of all voxels in Morton order; voxels at equal distances in it are spread evenly in space.
    """

    def __init__(self, size_m: tuple[float, float, float], voxel_m: float) -> None:
        """Cut a box of a size into voxels of about `voxel_m` that fill it exactly."""
        x, y, z = (max(1, round(size / voxel_m)) for size in size_m)
        self.shape = (x, y, z)
        self.step = np.array(size_m) / self.shape
        indices = np.stack(np.meshgrid(*map(np.arange, self.shape), indexing="ij"), axis=-1).reshape(-1, 3)
        self.centres: Array = (indices + 0.5) * self.step - np.array([size_m[0] / 2.0, size_m[1] / 2.0, 0.0])
        code = sum(
            ((indices >> bit & 1) << np.array([3 * bit, 3 * bit + 1, 3 * bit + 2])).sum(axis=1)
            for bit in range(max(self.shape).bit_length())
        )
        self.spread: NDArray[np.int64] = np.argsort(code, kind="stable")

    def inside(self, kind: ObjectType, face_T_thing: Pose2, z: float, margin_m: float) -> Mask:
        """Return the mask, shape (n,), of voxels whose centre is in an upright object, or near its sides or top.

        Args:
            kind: Shape and size of the object.
            face_T_thing: Its pose.
            z: Height of its base above the face, metres.
            margin_m: Greatest distance that counts as near.
        """
        x, y, theta = face_T_thing
        dx, dy = self.centres[:, 0] - x, self.centres[:, 1] - y
        width, depth, height = kind.size_m
        if kind.shape == "cylinder":
            within = np.hypot(dx, dy) <= width / 2.0 + margin_m
        else:
            along, across = math.cos(theta) * dx + math.sin(theta) * dy, math.cos(theta) * dy - math.sin(theta) * dx
            within = (np.abs(along) <= width / 2.0 + margin_m) & (np.abs(across) <= depth / 2.0 + margin_m)
        above = self.centres[:, 2] - z
        return np.asarray(within & (above > 0.0) & (above < height + margin_m))

    def contains(self, points: Array) -> Mask:
        """Return the mask, shape (m,), of points, shape (m, 3), that lie in the box."""
        offset = (points - self.centres[0]) / self.step + 0.5
        return np.asarray(((offset >= 0.0) & (offset < self.shape)).all(axis=1))

    def count(self, points: Array) -> NDArray[np.int64]:
        """Return the number of points in each voxel, shape (n,); all points, shape (m, 3), lie in the box."""
        x, y, z = np.floor((points - self.centres[0]) / self.step + 0.5).astype(np.int64).T
        return np.bincount((x * self.shape[1] + y) * self.shape[2] + z, minlength=len(self.centres))

    def window(self, size_m: tuple[float, float, float]) -> tuple[int, int, int]:
        """Return the least number of voxels that an object fills along x, y and z at any place, each at least 1."""
        thin = min(size_m[:2])
        across = [max(1, math.floor(thin / step)) for step in self.step[:2]]
        return (across[0], across[1], min(max(1, math.floor(size_m[2] / self.step[2])), self.shape[2]))


@dataclass(frozen=True, slots=True)
class Coverage:
    """The known part of a box.

    Attributes:
        grid: Its voxels.
        window: Number of voxels along x, y, z that the smallest object that may be hidden fills.
        known: Mask of the voxels that were seen to be empty or that a known object fills, shape (n,).
        contents: Share of the voxels that are known.
        hidden: Share of the places on the face at which the smallest object would fill unknown voxels only.
    """

    grid: Grid
    window: tuple[int, int, int]
    known: Mask
    contents: float = field(init=False)
    hidden: float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "contents", int(self.known.sum()) / self.known.size)
        object.__setattr__(self, "hidden", self._hidden())

    def with_known(self, known: Mask) -> "Coverage":
        """Return the coverage with more known voxels, shape (n,); a known voxel stays known."""
        return Coverage(self.grid, self.window, self.known | known)

    def unknown_around(self, x: float, y: float) -> float:
        """Return the share of unknown voxels among those of the smallest object at a place (x, y)."""
        half = self.grid.step * self.window / 2.0
        off = np.abs(self.grid.centres - (x, y, half[2]))
        there = (off <= np.maximum(half, self.grid.step / 2.0)).all(axis=1)
        return float(1.0 - self.known[there].mean()) if there.any() else 0.0

    def unknown_points(self, most: int, also: Mask) -> Array:
        """Return centres, (k, 3), of at most `most` voxels that are unknown or in the mask `also`, evenly spread."""
        order = self.grid.spread[(~self.known | also)[self.grid.spread]]
        count = min(most, len(order))
        return self.grid.centres[order[(2 * np.arange(count) + 1) * len(order) // (2 * max(count, 1))]]

    def _hidden(self) -> float:
        across, along, height = self.window
        dark = ~self.known.reshape(self.grid.shape)[:, :, :height].any(axis=2)
        if across > dark.shape[0] or along > dark.shape[1]:
            return 0.0
        fits = sliding_window_view(dark, (across, along)).all(axis=(2, 3))
        return int(fits.sum()) / fits.size

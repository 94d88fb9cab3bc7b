"""Small grids over a patch of a surface."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array

cv2.setNumThreads(1)

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """Square cells over a rectangle. origin: (2,) corner with the smallest x and y, m."""

    origin: Array
    cell: float
    shape: tuple[int, int]

    @classmethod
    def over(cls, points: Array, cell: float, margin: float = 0.0) -> Grid:
        """A grid that covers points (n, 2), n > 0, and `margin` m around them."""
        low = np.floor((points.min(axis=0) - margin) / cell) * cell
        count = np.floor((points.max(axis=0) + margin - low) / cell).astype(int) + 1
        return cls(low, cell, (int(count[0]), int(count[1])))

    def cells(self, points: Array) -> NDArray[np.int64]:
        """(n,) flat index of the cell of each point (n, 2), which must lie on the grid."""
        index = np.floor((points - self.origin) / self.cell).astype(np.int64)
        np.clip(index, 0, np.array(self.shape) - 1, out=index)
        return np.asarray(index[:, 0] * self.shape[1] + index[:, 1])

    def counts(self, points: Array) -> NDArray[np.int64]:
        """(nx, ny) how many points lie in each cell."""
        total = self.shape[0] * self.shape[1]
        return np.bincount(self.cells(points), minlength=total).reshape(self.shape)

    def centres(self) -> Array:
        """(nx, ny, 2) middle of each cell, m."""
        x = self.origin[0] + self.cell * (np.arange(self.shape[0]) + 0.5)
        y = self.origin[1] + self.cell * (np.arange(self.shape[1]) + 0.5)
        return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)


def components(mask: Mask) -> tuple[int, NDArray[np.int32]]:
    """Number of 8-connected components and labels (nx, ny), 0 where the mask is False."""
    count, labels = cv2.connectedComponents(mask.astype(np.uint8), connectivity=8)
    return count - 1, labels.astype(np.int32, copy=False)


def largest_component(mask: Mask) -> Mask:
    """The 8-connected component with the most cells; empty if there is none."""
    count, labels = components(mask)
    if count == 0:
        return np.zeros(mask.shape, dtype=bool)
    sizes = np.bincount(labels.ravel(), minlength=count + 1)[1:]
    return np.asarray(labels == 1 + int(sizes.argmax()))


def closed(mask: Mask, cells: int) -> Mask:
    """The mask with gaps of up to twice `cells` filled (dilated, then eroded, by a square)."""
    kernel = np.ones((2 * cells + 1, 2 * cells + 1), dtype=np.uint8)
    padded = np.pad(mask.astype(np.uint8), cells + 1)
    filled = cv2.erode(cv2.dilate(padded, kernel), kernel)
    return filled[cells + 1 : -cells - 1, cells + 1 : -cells - 1].astype(bool)


def opened(mask: Mask, cells: int) -> Mask:
    """The mask without parts that are at most twice `cells` wide (eroded, then dilated)."""
    kernel = np.ones((2 * cells + 1, 2 * cells + 1), dtype=np.uint8)
    padded = np.pad(mask.astype(np.uint8), cells + 1)
    kept = cv2.dilate(cv2.erode(padded, kernel), kernel)
    return kept[cells + 1 : -cells - 1, cells + 1 : -cells - 1].astype(bool)


def clearance(blocked: Mask, cell: float) -> Array:
    """Distance (nx, ny) in m from each cell's centre to the nearest blocked cell's centre."""
    if not blocked.any():
        return np.full(blocked.shape, np.inf)
    free = (~blocked).astype(np.uint8)
    distance = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return np.asarray(distance, dtype=np.float64) * cell

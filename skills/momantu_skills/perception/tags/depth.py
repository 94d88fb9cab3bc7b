"""The plane of a tag in the depth picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_bt.messages import CameraImage
from momantu_skills.perception.tags.detector import signed_area

LEAST_DEPTHS = 30
"""Fewest depth pixels on a tag for fitting its plane."""
PLANE_OUTLIER = 3.0
"""Multiple of the median residual above which a depth pixel is left out of the plane."""


@dataclass(frozen=True, slots=True, eq=False)
class TagPlane:
    """A tag's plane n.p = d in the optical frame, measured in depth.

    scaled: n / d (3,), 1/m; the inverse depth along a ray (x, y, 1) is `ray @ scaled`. covariance:
    of `scaled` (3, 3), from the scatter of the depth pixels about the plane.
    """

    scaled: Array
    covariance: Array


def plane_of(image: CameraImage, corners: Array) -> TagPlane | None:
    """Fit the plane of the depth pixels within corners (4, 2), px; None with too few of them.

    On a plane 1/z is linear in the pixel coordinates. Its noise is uniform there, because depth
    noise grows with z2. Therefore the fit is plain least squares, repeated once without outliers.
    """
    pixels = _pixels_within(image.depth.shape, corners)
    z = image.depth[pixels[:, 1], pixels[:, 0]].astype(np.float64)
    pixels, z = pixels[z > 0], z[z > 0]
    if len(z) < LEAST_DEPTHS:
        return None
    ways, inverse = rays(pixels.astype(np.float64), image.intrinsics), 1.0 / z
    scaled = np.linalg.lstsq(ways, inverse, rcond=None)[0]
    residuals = np.abs(ways @ scaled - inverse)
    kept = residuals <= PLANE_OUTLIER * max(float(np.median(residuals)), 1e-6)
    scaled = np.linalg.lstsq(ways[kept], inverse[kept], rcond=None)[0]
    if float(np.linalg.norm(scaled)) <= 1e-9:
        return None
    left = ways[kept] @ scaled - inverse[kept]
    variance = float(left @ left) / max(1, len(left) - 3)
    spread = variance * np.linalg.pinv(ways[kept].T @ ways[kept])
    return TagPlane(np.asarray(scaled), np.asarray(spread))


def rays(pixels: Array, intrinsics: Array) -> Array:
    """(n, 3) directions with z = 1 through pixels (n, 2)."""
    x = (pixels[:, 0] - intrinsics[0, 2]) / intrinsics[0, 0]
    y = (pixels[:, 1] - intrinsics[1, 2]) / intrinsics[1, 1]
    return np.column_stack([x, y, np.ones(len(pixels))])


def _pixels_within(shape: tuple[int, ...], corners: Array) -> NDArray[np.int64]:
    """Whole pixels (n, 2) as (column, row) inside a convex quadrilateral."""
    low = np.maximum(np.floor(corners.min(axis=0)).astype(int), 0)
    high = np.minimum(np.ceil(corners.max(axis=0)).astype(int), [shape[1] - 1, shape[0] - 1])
    columns, rows = np.meshgrid(
        np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1), indexing="xy"
    )
    pixels = np.column_stack([columns.ravel(), rows.ravel()])
    turn = np.ones(len(pixels), dtype=bool)
    sign = math.copysign(1.0, signed_area(corners))
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        along, relative = end - start, pixels - start
        turn &= sign * (along[0] * relative[:, 1] - along[1] * relative[:, 0]) >= 0.0
    return np.asarray(pixels[turn])


def mean_depth(depths: Sequence[NDArray[np.float32]]) -> NDArray[np.float32]:
    """Mean of the measured values of each pixel; 0 where nothing was measured."""
    measured = np.sum([depth > 0.0 for depth in depths], axis=0)
    total = np.sum(depths, axis=0, dtype=np.float64)
    return np.asarray(total / np.maximum(measured, 1), dtype=np.float32)

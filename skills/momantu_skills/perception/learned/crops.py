"""The part of a picture that shows what stands on a surface, at one scale, as the network sees it.

Its frame `level` has its origin on the surface below the camera; z is up, y is where the camera
looks, x to its right. So a thing looks the same wherever its table stands.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Transform, quaternion_from_axis_angle
from momantu_bt.messages import CameraImage
from momantu_skills.perception.geometry.regions import depth_inside

CHANNELS = 9
"""Height, normal (3), whether there is depth, colour (3), slope of the ray."""
NORMAL = slice(1, 4)
"""Where the normal is among the channels."""
SCALE = 0.0025
"""Size of a pixel at the things' middle distance, m."""
STEP = 16
"""The network's coarsest cell, px: a crop's sides are multiples of it."""
MOST_PIXELS = 90_000
"""Most pixels of a crop; a larger one gets coarser pixels."""
LOW, HIGH = 0.010, 0.45
"""Range of heights above the surface at which things are looked for, m."""
EDGE = 0.015
"""How far a thing may extend beyond the surface's outline, m."""
BORDER = 0.03
"""Margin of the crop around the things, m."""
LEAST = 80
"""Fewest pixels above a surface on which something stands."""
FILTER = 5
"""Edge of the window over which the surface's normals are measured, px."""


@dataclass(frozen=True, slots=True, eq=False)
class Crop:
    """A crop. points: (h, w, 3) in `level`, m; NaN without depth. color: (h, w, 3) uint8.

    odom_from_level: with the surface's correction of the camera's tilt. eye: height of the camera
    above the surface, m. rows, columns: (h,), (w,) the picture's pixels that were taken.
    """

    points: NDArray[np.float32]
    color: NDArray[np.uint8]
    odom_from_level: Transform
    eye: float
    rows: NDArray[np.int64]
    columns: NDArray[np.int64]

    def cells(self) -> Array:
        """The points (n, 3) of its cells of 2x2 pixels, in `level`, m; NaN without depth."""
        return self.points[::2, ::2].reshape(-1, 3).astype(np.float64)

    def shown(self) -> Array:
        """Those of its cells' points that have depth, (n, 3)."""
        points = self.cells()
        return points[np.isfinite(points[:, 2])]


def level_frame(odom_from_camera: Transform, height: float) -> Transform:
    """`odom_from_level` of a camera above a surface at a height, m."""
    ahead = odom_from_camera.rotation[:2, 2]
    if math.hypot(*ahead) < 1e-6:  # straight down: the picture's upper side is ahead
        ahead = -odom_from_camera.rotation[:2, 1]
    yaw = math.atan2(-ahead[0], ahead[1])
    x, y, _ = odom_from_camera.position
    return Transform((x, y, height), quaternion_from_axis_angle((0.0, 0.0, 1.0), yaw))


def cut(
    image: CameraImage, odom_from_camera: Transform, height: float, outline: Array
) -> Crop | None:
    """The crop of what stands on a surface; None if nothing does.

    odom_from_camera: corrected by the surface. height: of the surface, m. outline: (k, 2) its
    convex outline, odom.
    """
    odom_from_level = level_frame(odom_from_camera, height)
    level_from_camera = odom_from_level.inverse() @ odom_from_camera
    rows, columns = np.arange(image.depth.shape[0]), np.arange(image.depth.shape[1])
    coarse = _points(image, level_from_camera, rows[::2], columns[::2])
    eye = float(level_from_camera.position[2])
    box = _box(coarse, odom_from_level, outline, eye)
    if box is None:
        return None
    top, bottom, left, right, far = box
    step = max(1.0, SCALE / (far / image.intrinsics[0, 0]))
    high, wide = 2 * (bottom - top + 1), 2 * (right - left + 1)
    border = BORDER * image.intrinsics[0, 0] / far
    step *= max(1.0, math.sqrt((high + 2 * border) * (wide + 2 * border) / step**2 / MOST_PIXELS))
    rows = _taken(2 * top - border, 2 * bottom + border, step, len(rows))
    columns = _taken(2 * left - border, 2 * right + border, step, len(columns))
    points = _points(image, level_from_camera, rows, columns)
    color = np.ascontiguousarray(image.color[rows][:, columns])
    return Crop(points, color, odom_from_level, eye, rows, columns)


def channels(crop: Crop) -> NDArray[np.float32]:
    """What the network sees: (CHANNELS, h, w)."""
    points = crop.points
    known = np.isfinite(points[..., 2])
    filled = np.where(known[..., None], points, np.float32(0.0))
    height = np.clip(filled[..., 2], -0.1, 0.5)
    normal = _normals(filled, known)
    flat = np.hypot(filled[..., 0], filled[..., 1])
    ray = np.where(known, (crop.eye - filled[..., 2]) / np.maximum(flat, 0.05), 0.0)
    color = crop.color.astype(np.float32) / 127.5 - 1.0
    layers = [height / 0.1, *np.moveaxis(normal, 2, 0), known, *np.moveaxis(color, 2, 0), ray]
    return np.stack(layers).astype(np.float32)


def mirror(layers: NDArray[np.float32]) -> NDArray[np.float32]:
    """What the network would see in a mirror, from `channels` (CHANNELS, h, w)."""
    layers = layers[:, :, ::-1].copy()
    layers[NORMAL.start] *= -1.0
    return layers


def _points(
    image: CameraImage,
    level_from_camera: Transform,
    rows: NDArray[np.int64],
    columns: NDArray[np.int64],
) -> NDArray[np.float32]:
    """Points (h, w, 3) of some rows and columns in `level`, m; NaN without depth."""
    z = np.asarray(image.depth[rows][:, columns], dtype=np.float32)
    z = np.where(z > 0.0, z, np.float32(np.nan))
    k = image.intrinsics
    x = ((columns - k[0, 2]) / k[0, 0]).astype(np.float32)[None, :] * z
    y = ((rows - k[1, 2]) / k[1, 1]).astype(np.float32)[:, None] * z
    optical = np.stack([x, y, z], axis=-1)
    turn = level_from_camera.rotation.astype(np.float32)
    return np.asarray(optical @ turn.T + level_from_camera.position.astype(np.float32))


def _box(
    points: NDArray[np.float32], odom_from_level: Transform, outline: Array, eye: float
) -> tuple[int, int, int, int, float] | None:
    """First and last row and column of what stands on the surface, and its middle distance, m."""
    with np.errstate(invalid="ignore"):
        above = (points[..., 2] > LOW) & (points[..., 2] < HIGH)
    rows, columns = np.nonzero(above)
    flat = odom_from_level.apply(points[rows, columns])[:, :2]
    inside = depth_inside(flat, outline) > -EDGE
    mask: NDArray[Any] = np.zeros(above.shape, dtype=np.uint8)
    mask[rows[inside], columns[inside]] = 1
    mask = cv2.morphologyEx(mask, cv2.MORPH_OPEN, np.ones((3, 3), dtype=np.uint8))
    rows, columns = np.nonzero(mask)
    if len(rows) < LEAST:
        return None
    distance = np.linalg.norm(points[rows, columns] - (0.0, 0.0, eye), axis=1)
    far = float(np.nanmedian(distance))
    return int(rows.min()), int(rows.max()), int(columns.min()), int(columns.max()), far


def _taken(first: float, last: float, step: float, size: int) -> NDArray[np.int64]:
    """Rows (or columns) from first to last, every `step`; their number is a multiple of STEP."""
    count = max(STEP, math.ceil((last - first) / step / STEP) * STEP)
    middle = (first + last) / 2
    at = np.rint(middle + (np.arange(count) - (count - 1) / 2) * step).astype(np.int64)
    return np.asarray(np.clip(at, 0, size - 1))


def _normals(points: NDArray[np.float32], known: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Unit normals (h, w, 3) of smoothed points; 0 where they are not known."""
    window = (FILTER, FILTER)
    weight = cv2.boxFilter(known.astype(np.float32), -1, window)
    smooth = cv2.boxFilter(points, -1, window) / np.maximum(weight, 1e-6)[..., None]
    across = smooth[:, 2:] - smooth[:, :-2]
    down = smooth[2:] - smooth[:-2]
    normal = np.zeros_like(points)
    normal[1:-1, 1:-1] = np.cross(down[:, 1:-1], across[1:-1])
    long = np.linalg.norm(normal, axis=2, keepdims=True)
    normal /= np.maximum(long, 1e-12)
    normal[weight < 0.3] = 0.0
    return normal

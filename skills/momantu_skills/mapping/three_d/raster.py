"""What the kept turns show: the cloud, the floor plan and what overhangs it."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from momantu_bt.formats.maps import MapPicture
from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_skills.mapping.occupancy import BLACK, WHITE
from momantu_skills.mapping.three_d.mapper import CloudMapper
from momantu_skills.navigation.map.sensing import Rays

SECTORS = 720
"""Beams of the scan that is made of a kept turn: one each half degree."""
LOWEST = 0.1
"""Height above the floor below which a point may be the floor's, m: 20 m away at 5 mrad."""
_SPAN = 1 << 20
"""Cells of the cloud along each axis: 52 km at 5 cm."""


def cloud_of(mapper: CloudMapper) -> Array:
    """The map's points (n, 3), m: the mean of those in each voxel, sorted by their voxels."""
    edge, parts = mapper.config.cloud_voxel, []
    for pose, keyframe in zip(mapper.poses, mapper.keyframes, strict=True):
        points = pose.apply(keyframe.points.astype(np.float64))
        found, inverse, counts = np.unique(
            _voxels(points, edge), return_inverse=True, return_counts=True
        )
        parts.append((found, _sums(points, inverse, len(found)), counts))
    voxels, sums, counts = (np.concatenate(each) for each in zip(*parts, strict=True))
    found, inverse, seen = np.unique(voxels, return_inverse=True, return_counts=True)
    totals = _sums(sums, inverse, len(found))
    number = np.bincount(inverse, weights=counts, minlength=len(found))
    often = seen >= min(mapper.config.cloud_seen, len(mapper.keyframes))
    return np.asarray(totals[often] / number[often, None])


def _voxels(points: Array, edge: float) -> NDArray[np.int64]:
    """One number (n,) for the voxel of each point."""
    cells = np.floor(points / edge).astype(np.int64) + _SPAN // 2
    return np.asarray((cells[:, 0] * _SPAN + cells[:, 1]) * _SPAN + cells[:, 2])


def _sums(values: Array, groups: NDArray[np.int64], count: int) -> Array:
    """Sums (count, 3) of values (n, 3) by their group (n,)."""
    columns = [np.bincount(groups, weights=column, minlength=count) for column in values.T]
    return np.column_stack(columns)


def scans_of(
    mapper: CloudMapper, base_from_lidar: Transform, band: tuple[float, float]
) -> Iterator[tuple[Pose2D, Rays]]:
    """Kept turns as planar scans of what stands within a band of heights above the floor, m."""
    angles = (np.arange(SECTORS) + 0.5) * (2.0 * math.pi / SECTORS) - math.pi
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    origin = base_from_lidar.position[:2].copy()
    for pose, keyframe in zip(mapper.poses, mapper.keyframes, strict=True):
        points = keyframe.points.astype(np.float64)
        height = pose.apply(points)[:, 2]
        seen = points[(height >= band[0]) & (height <= band[1]), :2] - origin
        sectors = (
            (np.arctan2(seen[:, 1], seen[:, 0]) + math.pi) * (SECTORS / (2.0 * math.pi))
        ).astype(int)
        ranges = np.full(SECTORS, np.inf)
        np.minimum.at(ranges, sectors % SECTORS, np.hypot(seen[:, 0], seen[:, 1]))
        hit = np.isfinite(ranges)
        yield (
            Pose2D.from_transform(pose),
            Rays(origin, directions, np.where(hit, ranges, mapper.config.farthest), hit),
        )


def overhang_of(
    cloud: Array, plan: MapPicture, band: tuple[float, float], height: float
) -> MapPicture:
    """What a robot of that height meets and the band (lowest, highest) misses, as `plan` has it.

    cloud: (n, 3) points of the map, m.
    """
    z = cloud[:, 2]
    meets = ((z > LOWEST) & (z < band[0])) | ((z > band[1]) & (z < height))
    column, row = (
        np.floor((cloud[meets, :2] - np.array(plan.origin)) / plan.resolution).astype(int).T
    )
    rows, columns = plan.levels.shape
    on = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
    levels = np.full((rows, columns), WHITE, np.uint8)
    levels[row[on], column[on]] = BLACK
    return MapPicture(levels[::-1], plan.resolution, plan.origin, brightest=255)

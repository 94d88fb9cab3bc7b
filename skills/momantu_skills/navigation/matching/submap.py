"""A piece of the map that some scans made, rigid in itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Pose2D
from momantu_skills.navigation.matching import likelihood, lines, search
from momantu_skills.navigation.matching.config import MatchingConfig
from momantu_skills.navigation.matching.likelihood import Bytes
from momantu_skills.navigation.matching.scan import ScanPoints

_CAPACITY = 40_000
"""Most points of a growing submap: 50 m of wall on both sides, cell by cell."""


class Growing:
    """A submap into which scans are still entered; see `Submap`."""

    def __init__(self, config: MatchingConfig) -> None:
        self._config = config
        edge = round(2 * config.submap_reach / config.resolution)
        self.corner = np.full(2, -config.submap_reach)
        self.grid: Bytes = np.zeros((edge, edge), dtype=np.uint8)
        self.bound: Bytes = np.zeros((edge, edge), dtype=np.uint8)
        self.index = np.full((edge, edge), -1, dtype=np.int32)
        self.points, self.normals = np.zeros((_CAPACITY, 2)), np.zeros((_CAPACITY, 2))
        self.count = 0
        self._stamp = likelihood.stencil(config.spread, config.resolution)

    def add(self, pose: Pose2D, scan: ScanPoints) -> None:
        """Enter a scan at `submap_from_base`."""
        cell = self._config.resolution
        points = pose.apply(scan.points)
        likelihood.add_ends(self.grid, self.bound, self.corner, cell, points, self._stamp)
        self.count = lines.add_lines(
            self.index,
            self.count,
            self.points,
            self.normals,
            self.corner,
            cell,
            points,
            pose.rotate(scan.normals),
        )

    def finished(self) -> Submap | None:
        """The submap, without room to grow; None if nothing in it has a direction."""
        if not self.count:
            return None
        return Submap(
            self.points[: self.count].copy(), self.normals[: self.count].copy(), self._config
        )


class Submap:
    """The points (n, 2) of a finished submap and the normals (n, 2) there, in its frame."""

    def __init__(self, points: Array, normals: Array, config: MatchingConfig) -> None:
        self.points, self.normals = points, normals
        self.middle = points.mean(axis=0)
        self.corner = points.min(axis=0) - 1.0
        size = points.max(axis=0) + 1.0 - self.corner
        columns, rows = np.ceil(size / config.resolution).astype(int)
        self.index: NDArray[np.int32] = np.full((rows, columns), -1, dtype=np.int32)
        where = np.floor((points - self.corner) / config.resolution).astype(np.int64)
        self.index[where[:, 1], where[:, 0]] = np.arange(len(points))
        self.levels = self._levels(size, config)

    def _levels(self, size: Array, config: MatchingConfig) -> Bytes:
        cell = config.search_resolution
        stamp = likelihood.stencil(config.search_resolution, cell)
        columns, rows = np.ceil(size / cell).astype(int)
        grid: Bytes = np.zeros((rows, columns), dtype=np.uint8)
        likelihood.add_ends(grid, grid.copy(), self.corner, cell, self.points, stamp)
        return np.asarray(search.pyramid(grid))

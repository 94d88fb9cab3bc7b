"""Segmenting the points above a surface into objects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_skills.perception.geometry.grids import Grid, Mask, components
from momantu_skills.perception.geometry.regions import depth_inside
from momantu_skills.perception.surface.planes import Support


@dataclass(frozen=True)
class SegmentConfig:
    """How points above a surface are grouped into objects. Lengths in m."""

    floor: float = 0.012
    """Lower points belong to the surface: three sigma of the depth noise at 1.6 m."""
    edge: float = 0.015
    """How far an object may extend beyond the measured outline; a wall behind it is farther
    away."""
    ceiling: float = 0.50
    """Higher points do not belong to objects on the surface."""
    cell: float = 0.010
    """Points with a whole empty cell between them belong to two objects."""
    least_points: int = 40
    """Fewest points of an object."""
    least_height: float = 0.025
    """Least height of an object; lower ones are unevenness of the surface, or paper."""
    side_range: float = 0.012
    """A cell whose points span more height than this shows a side, not a top."""
    overhead: float = 0.2
    """Height above which another level surface may hang over the objects: the boards of a shelf."""
    overhead_area: float = 0.10
    """Least visible area of such a surface, m2; the tops of objects on a table have a tenth of
    it."""
    overhead_cell: float = 0.02
    """Cell size of the grid for that area."""
    overhead_slice: float = 0.02
    """Thickness of the slices in which such a surface is searched."""
    overhead_gap: float = 0.06
    """How far below its top such a surface begins: a board's thickness, and noise."""
    rim: float = 0.008
    """Height of the uppermost part of a side's cell, which may already be the top."""


@dataclass(frozen=True, slots=True, eq=False)
class Thing:
    """points: (n, 3) odom x, y and height above the surface, m. side: (n,) bool: on a side face."""

    points: Array
    side: Mask

    @property
    def height(self) -> float:
        """Height of the object, m: the level of its top face, or of the upper end of its sides."""
        heights = self.points[:, 2]
        highest = float(np.percentile(heights, 99.0))
        top = heights[(heights > highest - 0.012) & ~self.side]
        if len(top) < 15:
            return highest
        return float(np.median(top))

    def joined_with(self, other: Thing) -> Thing:
        """Both as one."""
        return Thing(
            np.concatenate([self.points, other.points]), np.concatenate([self.side, other.side])
        )


def things_on(support: Support, config: SegmentConfig | None = None) -> list[Thing]:
    """Everything that stands on the surface, in the order of the grid cells it covers."""
    config = config or SegmentConfig()
    points = support.points - [0.0, 0.0, support.height]
    top = headroom(support, config)
    standing = (points[:, 2] > config.floor) & (points[:, 2] < top) & ~support.on_plane
    standing[standing] = depth_inside(points[standing, :2], support.outline) > -config.edge
    return group(points[standing], config)


def headroom(support: Support, config: SegmentConfig) -> float:
    """Largest height of objects on the surface, m: the ceiling, or a surface that hangs over it."""
    points = support.points - [0.0, 0.0, support.height]
    above = points[(points[:, 2] > config.overhead) & (points[:, 2] < config.ceiling)]
    above = above[depth_inside(above[:, :2], support.outline) > 0.0]
    if not len(above):
        return config.ceiling
    grid = Grid.over(above[:, :2], config.overhead_cell)
    size = grid.shape[0] * grid.shape[1]
    slices = np.floor((above[:, 2] - config.overhead) / config.overhead_slice).astype(np.int64)
    covered = np.unique(slices * size + grid.cells(above[:, :2]))
    areas = np.bincount(covered // size) * config.overhead_cell**2
    wide = np.flatnonzero(areas >= config.overhead_area)
    if not len(wide):
        return config.ceiling
    return float(config.overhead + int(wide[0]) * config.overhead_slice - config.overhead_gap)


def group(points: Array, config: SegmentConfig) -> list[Thing]:
    """Connected things among points (n, 3)."""
    if len(points) < config.least_points:
        return []
    grid = Grid.over(points[:, :2], config.cell)
    cells = grid.cells(points[:, :2])
    count, labels = components(grid.counts(points[:, :2]) > 0)
    label = labels.ravel()[cells]
    side = _sides(points[:, 2], cells, config)
    found = [Thing(points[label == n], side[label == n]) for n in range(1, count + 1)]
    return [thing for thing in found if _is_thing(thing, config)]


def taken_out(thing: Thing, mask: Mask, config: SegmentConfig) -> Sequence[Thing]:
    """The remaining parts of an object without the points in `mask`, as objects of their own."""
    return group(thing.points[~mask], config)


def _is_thing(thing: Thing, config: SegmentConfig) -> bool:
    if len(thing.points) < config.least_points:
        return False
    return float(np.percentile(thing.points[:, 2], 95.0)) >= config.least_height


def _sides(heights: Array, cells: NDArray[np.int64], config: SegmentConfig) -> Mask:
    """Points of cells that span much height, except the uppermost ones: (n,) bool."""
    _, index = np.unique(cells, return_inverse=True)
    size = int(index.max()) + 1
    high, low = np.full(size, -np.inf), np.full(size, np.inf)
    np.maximum.at(high, index, heights)
    np.minimum.at(low, index, heights)
    steep = (high - low) > config.side_range
    return np.asarray(steep[index] & (heights < high[index] - config.rim))

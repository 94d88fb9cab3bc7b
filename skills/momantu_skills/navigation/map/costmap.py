"""The layered costmap: obstacles, and the clearance around them."""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from momantu_bt.formats.maps import FREE, OCCUPIED, UNKNOWN
from momantu_bt.geometry import Array, Pose2D
from momantu_bt.world import Site
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.map.believed import believed_maps
from momantu_skills.navigation.map.fields import Field, clearance, sample
from momantu_skills.navigation.map.maps import GridMap, overlaid
from momantu_skills.navigation.map.sensing import Rays
from momantu_skills.navigation.map.zones import Zones

FAR = 1.0
"""Clearance above which the value is capped, m; also the margin around a window that is
recomputed."""
SURE = 4
"""Count that a hit sets in its cell; each beam that later passes through the cell subtracts one."""
RANGE_DOUBT = 0.02
"""Heading error of the estimate, rad: hits this far off the map's walls are attributed to it."""
DEPTH_HITS = 3
"""Depth pixels that a cell needs to be occupied: single ones lie between near and far edges."""
LOW, TALL, MET = 1, 2, 3
"""What a cell of the depth layer shows: something the laser looks over; something that is taller;
something taller beside which the laser met something. The latter begins at `MET + SURE`, and each
beam that later passes through the cell subtracts one."""
MET_WITHIN, GONE_WITHIN = 0.275, 0.35
"""Where the laser met something within the first distance of a cell, m, it is the same thing; when
it meets nothing within the other, that has gone. A person's legs lie that far inside the arms."""


class Costmap:
    """Layers over the map's grid: map, overhang, zones, laser, depth. Coordinates are in the map.

    field: (rows, columns) distance to the nearest blocked cell, at most `FAR`, m. Zones to keep out
    of are blocked. known: what the map has, without zones. known_field, mapped_field: as `field`,
    of what is known with zones and without. preferred: cost factors (rows, columns) of the planner;
    None without preferred zones. frame: (x, y, resolution) of the grid, as the compiled kernels
    take it. looked: where the base stood at the newest depth picture; None before the first.
    movers: what moves, as rows of x, y, m, and of its velocity along both, m/s; it is no part of
    `field`. grows: the map is still being made; what it does not know then blocks no way. In a map
    that was told, nobody needs to go where it says nothing.
    """

    def __init__(
        self,
        grid: GridMap,
        overhang: GridMap | None,
        config: NavigationConfig,
        zones: Zones | None = None,
        *,
        grows: bool = False,
    ) -> None:
        self._config, self.grows, self.zones = config, grows, zones or Zones()
        self._read(grid)
        if overhang is not None:
            self.known |= overlaid(overhang, grid)
        self._laser = np.zeros(grid.cells.shape, dtype=np.uint8)
        self._depth = np.zeros(grid.cells.shape, dtype=np.uint8)
        self._close()
        self.movers = np.zeros((0, 4))
        self.looked: Pose2D | None = None

    def _read(self, grid: GridMap) -> None:
        self.grid = grid
        self.frame = np.array([*grid.origin, grid.resolution])
        self.known = grid.cells == OCCUPIED if self.grows else grid.cells != FREE
        self._from_known = clearance(grid.cells == OCCUPIED, grid.resolution)

    def _close(self) -> None:
        """Take what is known and the zones into the fields."""
        grid = self.grid
        self.mapped_field = np.minimum(clearance(self.known, grid.resolution), np.float32(FAR))
        self._closed, self.known_field = self.known, self.mapped_field
        kept_out = self.zones.blocked(grid)
        if kept_out is not None:
            self._closed = self.known | kept_out
            field = clearance(self._closed, grid.resolution)
            self.known_field = np.minimum(field, np.float32(FAR))
        self.preferred = self.zones.factors(grid, self._config.planner.preferred)
        self.field = self.known_field.copy()

    def use(self, grid: GridMap, new_from_old: Pose2D) -> None:
        """Take over the map as it has grown; what pictures showed is kept.

        new_from_old: how the map has moved where the robot is. What the laser saw is kept as long
        as neither that nor the raster changes; the map soon knows it too. Where it is lost, only a
        picture clears what pictures showed.
        """
        same = grid.cells.shape == self.grid.cells.shape and grid.origin == self.grid.origin
        kept = same and new_from_old == Pose2D(0.0, 0.0)
        self._depth[self._depth >= MET] = MET + SURE if kept else TALL
        marked = [(value, self._marked(value)) for value in (LOW, TALL, MET + SURE)]
        laser = self._laser
        self._read(grid)
        self._laser = np.zeros(grid.cells.shape, dtype=np.uint8)
        self._depth = np.zeros(grid.cells.shape, dtype=np.uint8)
        if kept:
            self._laser = laser
            self._laser[self._from_known <= self._config.known_reach] = 0
        c, s = math.cos(new_from_old.yaw), math.sin(new_from_old.yaw)
        for value, old in marked:
            there = old @ np.array([[c, s], [-s, c]]) + np.array([new_from_old.x, new_from_old.y])
            self._depth[self._counts(there) > 0] = value
        self._close()
        if self.looked is not None:
            self.looked = new_from_old @ self.looked
        self.refresh()

    @property
    def unknown(self) -> NDArray[np.bool_]:
        """The cells (rows, columns) of which the map knows nothing."""
        return np.asarray(self.grid.cells == UNKNOWN)

    def clear(self, where: NDArray[np.bool_] | None = None) -> None:
        """Clear what was seen, everywhere or in the cells `where` (rows, columns); look again."""
        cells = np.ones(self.known.shape, dtype=np.bool_) if where is None else where
        self._laser[cells] = 0
        self._depth[cells] = 0
        self.looked = None
        self.refresh()

    def square(self, x: float, y: float, edge: float) -> NDArray[np.bool_]:
        """The cells (rows, columns) in a square around a point of the map; edge: m."""
        rows, columns = np.indices(self.known.shape)
        off_x = self.frame[0] + (columns + 0.5) * self.frame[2] - x
        off_y = self.frame[1] + (rows + 0.5) * self.frame[2] - y
        return np.asarray((np.abs(off_x) <= edge / 2) & (np.abs(off_y) <= edge / 2))

    def clear_ahead(self, map_from_base: Pose2D, blind: float = 0.0) -> None:
        """Clear what was seen ahead of the base, which can be seen again; keep what lies behind.

        blind: distance from the base up to which no picture shows anything, m: what pictures showed
        there before is kept too.
        """
        rows, columns = np.mgrid[0 : self.grid.cells.shape[0], 0 : self.grid.cells.shape[1]]
        x = self.frame[0] + (columns + 0.5) * self.frame[2] - map_from_base.x
        y = self.frame[1] + (rows + 0.5) * self.frame[2] - map_from_base.y
        ahead = math.cos(map_from_base.yaw) * x + math.sin(map_from_base.yaw) * y > 0.0
        self._laser[ahead] = 0
        self._depth[ahead & (np.hypot(x, y) > blind)] = 0
        self.refresh()

    def see_laser(self, map_from_base: Pose2D, rays: Rays) -> None:
        """Mark the hits of a scan and clear the cells that its beams passed through.

        What pictures showed of something that the laser met, too, is cleared with it.
        """
        _trace(
            self._laser,
            self._depth,
            self._from_known,
            self.frame,
            np.array([map_from_base.x, map_from_base.y, map_from_base.yaw], dtype=np.float64),
            rays.origin,
            rays.directions,
            rays.ranges,
            rays.hit,
            self._config.laser_reach,
            self._config.known_reach,
        )
        self._clear_gone()

    def _clear_gone(self) -> None:
        """Clear what pictures showed where the laser met something, and meets nothing any more."""
        passed = np.argwhere(self._depth == MET)
        passed = passed[self._from_known[tuple(passed.T)] > GONE_WITHIN]
        gone = passed[~self._met(passed, GONE_WITHIN)]
        self._depth[tuple(gone.T)] = 0

    def _met(self, cells: NDArray[np.int64], within: float) -> NDArray[np.bool_]:
        """Which cells (n, 2), by row and column, the laser met something near; within: m."""
        marks = np.argwhere(self._laser > 0) if len(cells) else cells
        if not len(marks):
            return np.zeros(len(cells), dtype=np.bool_)
        off, _ = cKDTree(marks).query(cells)
        return np.asarray(off * self.frame[2] <= within)

    def forget(self, places: Array, radius: float) -> None:
        """Clear what was seen within `radius` m of points (n, 2): it moves, or has gone."""
        reach = math.ceil(radius / self.frame[2])
        rows, columns = self.known.shape
        for x, y in places:
            row, column = self.grid.index(float(x), float(y))
            square = _square(row, column, reach, rows, columns)
            r, c = np.mgrid[square]
            off_x = self.frame[0] + (c + 0.5) * self.frame[2] - x
            off_y = self.frame[1] + (r + 0.5) * self.frame[2] - y
            near = np.hypot(off_x, off_y) <= radius
            self._laser[square][near] = 0
            self._depth[square][near] = 0

    def see_depth(self, obstacles: Array, floor: Array, laser: float = 0.0) -> None:
        """Mark cells with obstacle points (n, 3); clear those with floor points (m, 2).

        z of an obstacle's point is its height above the floor. laser: that of the laser's plane, m;
        what is lower is not seen by it.
        """
        bare = self._counts(floor) >= DEPTH_HITS
        taken = self._counts(obstacles[:, :2]) >= DEPTH_HITS
        tall = self._counts(obstacles[obstacles[:, 2] > laser, :2]) > 0
        self._depth[bare & ~taken] = 0
        taken &= self.mapped_field > self._config.known_reach
        self._depth[taken] = np.where(tall[taken], TALL, LOW)
        seen = np.argwhere(taken & tall)
        self._depth[tuple(seen[self._met(seen, MET_WITHIN)].T)] = MET + SURE

    def low_things(self) -> Array:
        """Middles (n, 2) of the cells in which pictures show something below the laser's plane."""
        return self._marked(LOW)

    def _marked(self, value: int) -> Array:
        rows, columns = np.nonzero(self._depth == value)
        return np.asarray(self.frame[:2] + (np.column_stack([columns, rows]) + 0.5) * self.frame[2])

    def lay(self, low_things: Array) -> None:
        """Mark what was seen before below the laser's plane: points (n, 2)."""
        self._depth[self._counts(low_things) > 0] = LOW

    def _counts(self, points: Array) -> NDArray[np.int64]:
        rows, columns = self.grid.cells.shape
        cells = np.floor((points - self.frame[:2]) / self.frame[2]).astype(np.int64)
        inside = (cells >= 0).all(axis=1) & (cells[:, 0] < columns) & (cells[:, 1] < rows)
        flat = cells[inside, 1] * columns + cells[inside, 0]
        return np.bincount(flat, minlength=rows * columns).reshape(rows, columns)

    def refresh(self, center: Pose2D | None = None, radius: float = 2.5) -> None:
        """Recompute the clearance: everywhere, or within a square around `center`."""
        rows, columns = self.grid.cells.shape
        window = pad = (slice(0, rows), slice(0, columns))
        if center is not None:
            row, column = self.grid.index(center.x, center.y)
            reach, more = (math.ceil(r / self.grid.resolution) for r in (radius, radius + FAR))
            window = _square(row, column, reach, rows, columns)
            pad = _square(row, column, more, rows, columns)
        blocked = self._closed[pad] | (self._laser[pad] > 0) | (self._depth[pad] > 0)
        if blocked.size == 0:
            return
        fresh = np.minimum(clearance(blocked, self.grid.resolution), np.float32(FAR))
        r, c = window[0].start - pad[0].start, window[1].start - pad[1].start
        height, width = window[0].stop - window[0].start, window[1].stop - window[1].start
        self.field[window] = fresh[r : r + height, c : c + width]

    def room(self, pose: Pose2D, discs: Array, *, known: bool = False) -> float:
        """Clearance in m of a footprint (discs (m, 3)) at a pose; negative in a collision.

        known: use the map's layers only.
        """
        field = self.known_field if known else self.field
        x, y, yaw = float(pose.x), float(pose.y), float(pose.yaw)
        return float(room(field, self.frame, discs, x, y, yaw))


def of_site(site: Site, config: NavigationConfig) -> Costmap:
    """The costmap of a site, before anything was seen; ValueError if the site has no map."""
    if site.map_file is None:
        raise ValueError(f"site {site.name!r} has no map_file to drive in")
    grid, overhang = believed_maps(site)
    return Costmap(grid, overhang, config, Zones(site.zones))


def _square(row: int, column: int, reach: int, rows: int, columns: int) -> tuple[slice, slice]:
    def clipped(middle: int, end: int) -> slice:
        low = min(max(middle - reach, 0), end)
        return slice(low, min(max(middle + reach + 1, low), end))

    return clipped(row, rows), clipped(column, columns)


@numba.njit(cache=True)
def room(field: Field, frame: Array, discs: Array, x: float, y: float, yaw: float) -> float:
    """Clearance in m: the least distance from any disc to a blocked cell; 0 off the grid."""
    c = math.cos(yaw)
    s = math.sin(yaw)
    least = 1e9
    for i in range(discs.shape[0]):
        px = x + c * discs[i, 0] - s * discs[i, 1]
        py = y + s * discs[i, 0] + c * discs[i, 1]
        column = (px - frame[0]) / frame[2] - 0.5
        row = (py - frame[1]) / frame[2] - 0.5
        least = min(least, sample(field, column, row, 0.0) - discs[i, 2])
    return least


@numba.njit(cache=True)
def _trace(
    marks: NDArray[np.uint8],
    shown: NDArray[np.uint8],
    from_known: Field,
    frame: Array,
    pose: Array,
    origin: Array,
    directions: Array,
    ranges: Array,
    hit: NDArray[np.bool_],
    reach: float,
    known_reach: float,
) -> None:
    rows, columns = marks.shape
    c = math.cos(pose[2])
    s = math.sin(pose[2])
    x = (pose[0] + c * origin[0] - s * origin[1] - frame[0]) / frame[2]
    y = (pose[1] + s * origin[0] + c * origin[1] - frame[1]) / frame[2]
    for i in range(ranges.shape[0]):
        dx = c * directions[i, 0] - s * directions[i, 1]
        dy = s * directions[i, 0] + c * directions[i, 1]
        length = min(ranges[i], reach) if hit[i] else reach
        last_row = -1
        last_column = -1
        for step in range(int(length / frame[2]) - 1):
            column = math.floor(x + dx * step)
            row = math.floor(y + dy * step)
            if not (0 <= row < rows and 0 <= column < columns):
                break
            if row != last_row or column != last_column:
                if marks[row, column] > 0:
                    marks[row, column] -= 1
                if shown[row, column] > MET:
                    shown[row, column] -= 1
            last_row = row
            last_column = column
    for i in range(ranges.shape[0]):
        if not hit[i] or ranges[i] >= reach:
            continue
        length = ranges[i] / frame[2]
        column = math.floor(x + (c * directions[i, 0] - s * directions[i, 1]) * length)
        row = math.floor(y + (s * directions[i, 0] + c * directions[i, 1]) * length)
        if not (0 <= row < rows and 0 <= column < columns):
            continue
        if from_known[row, column] > known_reach + RANGE_DOUBT * ranges[i]:
            marks[row, column] = SURE

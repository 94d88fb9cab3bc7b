"""Where a robot can stand by its maps: poses that a tree gives are compared with the floor plan."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.errors import PLUGIN_ERRORS
from momantu_bt.formats.maps import FREE, OCCUPIED, MapPicture, read_map
from momantu_bt.geometry import Pose2D
from momantu_bt.importing import output_aside
from momantu_bt.robot import RobotDescription
from momantu_bt.world import MappedWorld, WorldEntry

FARTHEST = 4.0
"""m; how far from a wrong pose a free one is searched."""
STEP = 0.1
"""m between poses that are tried."""
ROOM = 0.1
"""m between the base and what stands near it, at a pose that is proposed."""


@dataclass(frozen=True, slots=True, eq=False)
class Floor:
    """The known floor. taken: cells (rows, columns) where nothing can stand, row 0 at the least y.

    resolution: m per cell. origin: map coordinates of the lower left corner, m. footprint: corners
    of the base (n, 2) in its frame, m.
    """

    taken: NDArray[np.bool_]
    resolution: float
    origin: tuple[float, float]
    footprint: NDArray[np.float64]

    @property
    def area(self) -> tuple[float, float, float, float]:
        """The least x and y and the largest x and y of the map, m."""
        rows, columns = self.taken.shape
        x, y = self.origin
        return x, y, x + columns * self.resolution, y + rows * self.resolution

    def is_free(self, pose: Pose2D, room: float = 0.0) -> bool:
        """Whether the base stands on free floor alone. room: m that it needs around it."""
        at = self._cells_below(pose, room)
        inside = ((at >= 0) & (at < self.taken.shape)).all(axis=1)
        return bool(inside.all()) and not bool(self.taken[at[:, 0], at[:, 1]].any())

    def nearest_free(self, pose: Pose2D) -> Pose2D | None:
        """The nearest pose with the same heading where the base has room; None if none is near."""
        count = round(FARTHEST / STEP)
        steps = [(i, j) for i in range(-count, count + 1) for j in range(-count, count + 1)]
        for i, j in sorted(steps, key=lambda step: (math.hypot(*step), step)):
            tried = Pose2D(round(pose.x + i * STEP, 2), round(pose.y + j * STEP, 2), pose.yaw)
            if self.is_free(tried, ROOM):
                return tried
        return None

    def _cells_below(self, pose: Pose2D, room: float) -> NDArray[np.int_]:
        """The rows and columns (n, 2) of the cells whose centre lies below the base."""
        reach = float(np.hypot(*self.footprint.T).max()) + room
        low = np.floor((np.array([pose.y, pose.x]) - reach - self.origin[::-1]) / self.resolution)
        size = math.ceil(2 * reach / self.resolution) + 1
        rows, columns = np.mgrid[:size, :size] + low.astype(int)[:, None, None]
        x = self.origin[0] + (columns + 0.5) * self.resolution - pose.x
        y = self.origin[1] + (rows + 0.5) * self.resolution - pose.y
        c, s = math.cos(pose.yaw), math.sin(pose.yaw)
        below = _within(np.stack([c * x + s * y, c * y - s * x], axis=-1), self.footprint, room)
        return np.stack([rows[below], columns[below]], axis=1)


def _within(
    points: NDArray[np.float64], outline: NDArray[np.float64], room: float
) -> NDArray[np.bool_]:
    """Which points lie in a polygon, or at most `room` beside one of its edges."""
    inside = np.zeros(points.shape[:-1], dtype=bool)
    near = np.full(points.shape[:-1], np.inf)
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        along = b - a
        crosses = (a[1] > points[..., 1]) != (b[1] > points[..., 1])
        with np.errstate(divide="ignore", invalid="ignore"):
            at = a[0] + (points[..., 1] - a[1]) * along[0] / along[1]
        inside ^= crosses & (points[..., 0] < at)
        share = ((points - a) @ along / max(float(along @ along), 1e-12)).clip(0.0, 1.0)
        away = points - a - share[..., None] * along
        near = np.minimum(near, np.hypot(away[..., 0], away[..., 1]))
    return inside | (near < room)


def floor_of(entry: WorldEntry | None, description: RobotDescription | None) -> Floor | None:
    """The floor of a world as its maps show it to a robot; None if they are not known.

    A map that cannot be drawn or read is told when the world is opened, not here.
    """
    if description is None or not isinstance(entry, MappedWorld):
        return None
    try:
        with output_aside():
            site = entry.site_for(description)
            if site.map_file is None:
                return None
            plan = read_map(site.map_file)
            taken = plan.cells() != FREE
            if site.overhang_file is not None:
                taken = taken | _overhangs(read_map(site.overhang_file), taken.shape)
    except PLUGIN_ERRORS:
        return None
    footprint = np.array(description.footprint, dtype=float)
    return Floor(taken, plan.resolution, plan.origin, footprint)


def _overhangs(layer: MapPicture, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    cells: NDArray[np.bool_] = layer.cells() == OCCUPIED
    return cells if cells.shape == shape else np.zeros(shape, dtype=bool)

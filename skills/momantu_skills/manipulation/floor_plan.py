"""What the map knows to stand on the floor, as the arm asks for it."""

from __future__ import annotations

import numpy as np

from momantu_bt.failure import FRAME_UNKNOWN, Failure
from momantu_bt.frames import MAP, ODOM, FrameBuffer
from momantu_bt.geometry import Array
from momantu_bt.world import Site
from momantu_skills.navigation.fields import clearance
from momantu_skills.navigation.maps import OCCUPIED, read_map

FAR = 10.0
"""m; what is far from everything, or on no map."""


class FloorPlan:
    """Distances to what a site's maps know: walls, furniture and what hangs over the floor."""

    def __init__(self, site: Site, frames: FrameBuffer) -> None:
        self._frames = frames
        files = [file for file in (site.map_file, site.overhang_file) if file is not None]
        grids = [read_map(file) for file in files]
        self._layers = [(g, clearance(g.cells == OCCUPIED, g.resolution)) for g in grids]

    def distance(self, points: Array) -> Array:
        """(n,) m along the floor from points (n, 3) in odom; FAR while nobody knows where it is."""
        least = np.full(len(points), FAR)
        try:
            map_from_odom = self._frames.lookup(MAP, ODOM)
        except Failure as failure:
            if failure.code != FRAME_UNKNOWN:
                raise
            return least
        there = map_from_odom.apply(points)[:, :2]
        for grid, field in self._layers:
            cells = np.floor((there - np.array(grid.origin)) / grid.resolution).astype(np.int64)
            rows, columns = field.shape
            on = (cells >= 0).all(axis=1) & (cells[:, 0] < columns) & (cells[:, 1] < rows)
            least[on] = np.minimum(least[on], field[cells[on, 1], cells[on, 0]])
        return least

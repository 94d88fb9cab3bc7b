"""What the site's maps know as columns, each as tall as a wall unless pictures have seen over it.

Maps contain no heights. A surface has one, so its cells are no columns: its support stands for it.
"""

from __future__ import annotations

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.world import Site
from momantu_skills.manipulation.model.collision import Cells
from momantu_skills.manipulation.scene.surroundings import SeenSpace
from momantu_skills.navigation.map.believed import believed_maps
from momantu_skills.navigation.map.fields import clearance
from momantu_skills.navigation.map.heights import tall_cells

WALL = 2.2
"""Height of a column, m: above it no arm reaches, and few walls end below."""
SKIN = 0.16
"""How deep the cells inside an obstacle are kept, m: no motion passes a skin of this thickness
between two of its checks."""
DOUBT = 0.04
"""Share of its depth by which a picture may be wrong about what lies behind a cell."""
HALF_DIAGONAL = 0.5 * 3**0.5
"""Of a cube, in edges."""


class Columns:
    """The columns of a site. edge: of their square cells, m; 0 without a map."""

    def __init__(self, site: Site) -> None:
        """Read the site's maps, with its surfaces as believed now.

        Raises:
            MapError: a file is missing or broken.
        """
        self._centres, self._corner, self.edge = np.empty((0, 2)), (0.0, 0.0), 0.0
        grids = believed_maps(site)
        if grids:
            tall = tall_cells(grids, tuple(site.surfaces.values()))
            grid = grids[0]
            skin = tall & (clearance(~tall, grid.resolution) < SKIN)
            self._centres = grid.centers(skin)
            self._corner, self.edge = grid.origin, grid.resolution

    def near(self, x: float, y: float, reach: float) -> Array:
        """Centres (n, 2) of the columns within `reach` m of a point, map, m."""
        off = self._centres - (x, y)
        return np.asarray(self._centres[np.einsum("ij,ij->i", off, off) < reach * reach])

    def unseen(
        self, centres: Array, seen: SeenSpace, odom_from_map: Transform
    ) -> tuple[Array, float]:
        """Centres (m, 3), map, of the cubes of columns (n, 2) that no picture shows to be free."""
        if not len(centres):
            return np.empty((0, 3)), self.edge
        layers = (np.arange(round(WALL / self.edge)) + 0.5) * self.edge
        cubes = np.column_stack(
            [np.repeat(centres, len(layers), axis=0), np.tile(layers, len(centres))]
        )
        free = seen.free(odom_from_map.apply(cubes), HALF_DIAGONAL * self.edge, DOUBT)
        return cubes[~free], self.edge

    def cells(
        self,
        odom_from_base: Transform,
        odom_from_map: Transform,
        seen: SeenSpace,
        reach: float,
        doubt: float,
    ) -> Cells | None:
        """The cubes within `reach` m of the base as obstacles for the arm; None if there is none.

        doubt: how much nearer they may be, m. Their frame is the map's, moved to the corner of its
        grid, whose raster they keep.
        """
        x, y, _ = (odom_from_map.inverse() @ odom_from_base).position
        cubes, edge = self.unseen(self.near(float(x), float(y), reach), seen, odom_from_map)
        if not len(cubes):
            return None
        corner = Transform((*self._corner, 0.0))
        base_from_corner = odom_from_base.inverse() @ odom_from_map @ corner
        return Cells("map", cubes - corner.position, edge, base_from_corner, doubt)

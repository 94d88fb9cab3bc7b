"""The site's maps as believed: what shows a surface that was found elsewhere is drawn there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from momantu_bt.formats.maps import FREE, OCCUPIED
from momantu_bt.messages import frozen
from momantu_bt.redrawing import Raster
from momantu_bt.world import Site, Surfaces
from momantu_skills.navigation.map.maps import GridMap, read_grid


def believed_maps(site: Site) -> list[GridMap]:
    """The floor plan and the map of what overhangs it; none of both if the site has no plan.

    If the site has a plan alone, as one that a laser made, its surfaces are what overhangs it.

    Raises:
        MapError: a file is missing or broken.
    """
    if site.map_file is None:
        return []
    plan = _believed(read_grid(site.map_file), site)
    if site.overhang_file is None:
        return [plan, _tops(plan, site)]
    return [plan, _believed(read_grid(site.overhang_file), site)]


def corrections(site: Site) -> int:
    """How often a surface of the site was found elsewhere; the maps change with it."""
    return site.surfaces.corrections if isinstance(site.surfaces, Surfaces) else 0


def raster(grid: GridMap) -> Raster:
    """The cells of a map."""
    return Raster(grid.cells.shape, grid.resolution, grid.origin)


def _tops(plan: GridMap, site: Site) -> GridMap:
    """The tops of a site's surfaces, drawn on the raster of its floor plan."""
    cells = np.full(plan.cells.shape, FREE, dtype=plan.cells.dtype)
    for surface in site.surfaces.values():
        cells[raster(plan).on(surface)] = OCCUPIED
    return replace(plan, cells=frozen(cells))


def _believed(grid: GridMap, site: Site) -> GridMap:
    surfaces = site.surfaces
    if not isinstance(surfaces, Surfaces) or not surfaces.corrected:
        return grid
    told = surfaces.told
    changes = [
        raster(grid).moved(grid.cells == OCCUPIED, told[name], surfaces[name])
        for name in surfaces.corrected
    ]
    cells = grid.cells.copy()
    for erased, _ in changes:
        cells[erased] = FREE
    for _, drawn in changes:
        cells[drawn] = OCCUPIED
    return replace(grid, cells=frozen(cells))

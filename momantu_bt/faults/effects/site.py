"""Wrong sites: the robot gets false information; the world does not change."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np

from momantu_bt.fault import Fault, FaultError
from momantu_bt.faults.effects.moved_surface import moved_surfaces
from momantu_bt.formats.maps import MapError, MapPicture, read_map, write_map
from momantu_bt.formats.names import valid_names
from momantu_bt.world import Site, seeded

NEAR = 5.0
"""The missing piece of wall is within this distance of the start, m, if walls are there."""


def wrong_site(site: Site, fault: Fault, seed: int, folder: Path) -> Site:
    """The site with the fault in it. folder: changed maps may be written there.

    Raises:
        FaultError: the site has nothing that this fault can break.
    """
    if fault.name == "table.height":
        return _other_heights(site, fault)
    if fault.name == "table.moved":
        return _other_places(site, fault, seed, folder)
    return _other_map(site, fault, seed, folder)


def _other_heights(site: Site, fault: Fault) -> Site:
    wanted, by = _wanted(site, fault), float(fault.parameters["by"])
    surfaces = {
        name: replace(surface, height=surface.height + by) if wanted in ("", name) else surface
        for name, surface in site.surfaces.items()
    }
    low = [name for name, surface in surfaces.items() if surface.height <= 0.0]
    if low:
        raise FaultError(f"{fault.name}: {low[0]} would lie below the floor")
    return replace(site, surfaces=MappingProxyType(surfaces))


def _wanted(site: Site, fault: Fault) -> str:
    """The name of the surface that the fault is about; "" for all."""
    wanted = str(fault.parameters["surface"])
    if not site.surfaces:
        raise FaultError(f"{fault.name}: {site.name} has no surfaces")
    if wanted and wanted not in site.surfaces:
        hint = valid_names(wanted, site.surfaces, "surfaces")
        raise FaultError(f"{fault.name}: {site.name} has no surface {wanted!r}; {hint}")
    return wanted


def _other_places(site: Site, fault: Fault, seed: int, folder: Path) -> Site:
    _wanted(site, fault)
    files = tuple(file for file in (site.map_file, site.overhang_file) if file is not None)
    try:
        maps = tuple(map(read_map, files))
    except MapError as error:
        raise FaultError(f"{fault.name}: {error}") from None
    surfaces, changed = moved_surfaces(site.surfaces, maps, fault, seed)
    for file, plan in zip(files, changed, strict=True):
        _written(plan, file, folder, (0.0, 0.0))
    return replace(
        site,
        surfaces=surfaces,
        map_file=None if site.map_file is None else folder / site.map_file.name,
        overhang_file=None if site.overhang_file is None else folder / site.overhang_file.name,
    )


def _other_map(site: Site, fault: Fault, seed: int, folder: Path) -> Site:
    if site.map_file is None:
        raise FaultError(f"{fault.name}: {site.name} has no floor plan")
    random = seeded(seed, fault.name)
    heading = float(random.uniform(-math.pi, math.pi))
    shift, missing = float(fault.parameters["shift"]), float(fault.parameters["missing"])
    way = (shift * math.cos(heading), shift * math.sin(heading))
    try:
        plan = read_map(site.map_file)
        hanging = None if site.overhang_file is None else read_map(site.overhang_file)
    except MapError as error:
        raise FaultError(f"{fault.name}: {error}") from None
    if missing > 0.0:
        plan = _without_wall(plan, site, missing, random)
    changed = replace(site, map_file=_written(plan, site.map_file, folder, way))
    if hanging is not None and site.overhang_file is not None:
        file = _written(hanging, site.overhang_file, folder, way)
        changed = replace(changed, overhang_file=file)
    return changed


def _without_wall(
    plan: MapPicture, site: Site, length: float, random: np.random.Generator
) -> MapPicture:
    """The plan with a free square, `length` m wide, around a piece of wall."""
    walls = np.argwhere(plan.occupied())
    if not len(walls):
        raise FaultError("map.wrong: there is no wall on the floor plan")
    levels = plan.levels.copy()
    x = plan.origin[0] + (walls[:, 1] + 0.5) * plan.resolution
    y = plan.origin[1] + (len(levels) - walls[:, 0] - 0.5) * plan.resolution
    near = np.hypot(x - site.start.x, y - site.start.y) < NEAR
    choice = walls[near] if near.any() else walls
    row, column = choice[int(random.integers(len(choice)))]
    half = max(0, round(length / plan.resolution / 2.0))
    rows, columns = (slice(max(0, at - half), at + half + 1) for at in (row, column))
    levels[rows, columns] = plan.free_level
    return replace(plan, levels=levels)


def _written(plan: MapPicture, file: Path, folder: Path, shift: tuple[float, float]) -> Path:
    """Write a plan into a folder, under its file's name; shift: along x and y, m."""
    origin = plan.origin[0] + shift[0], plan.origin[1] + shift[1]
    write_map(folder / file.name, replace(plan, origin=origin))
    return folder / file.name

"""table.moved: the robot is told that surfaces, and what is drawn of them, stand elsewhere."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TypeAlias

from momantu_bt.fault import Fault, FaultError
from momantu_bt.formats.maps import MapPicture
from momantu_bt.geometry import Pose2D
from momantu_bt.redrawing import DRAWN, Raster, surface_at
from momantu_bt.world import Surface, seeded

DIRECTIONS = 24
"""Directions that are tried, from one of the seed's."""
WHOLE = 0.9
"""Least share of a surface that lies on the floor plan."""
Maps: TypeAlias = tuple[MapPicture, ...]


def moved_surfaces(
    surfaces: Mapping[str, Surface], maps: Maps, fault: Fault, seed: int
) -> tuple[Mapping[str, Surface], Maps]:
    """The surfaces and maps with what `fault` moves told at another place, where nothing is drawn.

    Parameters: distance, m; turn, rad, of the table in the world; surface, all if empty.

    Raises:
        FaultError: nothing on the maps is free at that distance.
    """
    wanted = str(fault.parameters["surface"])
    told = dict(surfaces)
    for name, surface in surfaces.items():
        if wanted in ("", name):
            told[name], maps = _elsewhere(name, surface, maps, fault, seed)
    return MappingProxyType(told), maps


def _elsewhere(
    name: str, surface: Surface, maps: Maps, fault: Fault, seed: int
) -> tuple[Surface, Maps]:
    distance, turn = float(fault.parameters["distance"]), float(fault.parameters["turn"])
    start = float(seeded(seed, fault.name, name).uniform(-math.pi, math.pi))
    here = surface.map_from_surface
    for number in range(DIRECTIONS):
        heading = start + 2 * math.pi * number / DIRECTIONS
        x, y = here.x + distance * math.cos(heading), here.y + distance * math.sin(heading)
        told = surface_at(surface, Pose2D(x, y, here.yaw - turn))
        if all(_free(one, surface, told) for one in maps):
            return told, tuple(_drawn(one, surface, told) for one in maps)
    raise FaultError(f"{fault.name}: nothing on the floor plan is free {distance:g} m from {name}")


def _raster(picture: MapPicture) -> Raster:
    return Raster(picture.levels.shape, picture.resolution, picture.origin)


def _free(picture: MapPicture, here: Surface, there: Surface) -> bool:
    """Whether a surface lies on the map elsewhere, and nothing else is drawn there."""
    raster = _raster(picture)
    inside = raster.on(there, DRAWN)
    area = (there.size[0] + 2 * DRAWN) * (there.size[1] + 2 * DRAWN)
    other = picture.occupied()[::-1] & ~raster.on(here, DRAWN)
    return bool(inside.sum() * picture.resolution**2 > WHOLE * area and not (other & inside).any())


def _drawn(picture: MapPicture, here: Surface, there: Surface) -> MapPicture:
    """The map with the surface drawn elsewhere."""
    occupied = picture.occupied()
    erased, drawn = _raster(picture).moved(occupied[::-1], here, there)
    levels = picture.levels.copy()
    darkest = picture.levels[occupied][:1]
    levels[erased[::-1]] = picture.free_level
    levels[drawn[::-1]] = darkest
    return replace(picture, levels=levels)

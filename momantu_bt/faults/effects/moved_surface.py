"""table.moved: the robot is told that surfaces, and what is drawn of them, stand elsewhere."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from momantu_bt.fault import Fault, FaultError
from momantu_bt.formats.maps import MapPicture
from momantu_bt.geometry import Pose2D
from momantu_bt.world import Surface, seeded

DRAWN = 0.06
"""How far around a surface what is drawn on the maps belongs to it, m."""
DIRECTIONS = 24
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
    bare = tuple(_without(one, surface) for one in maps)
    here = surface.map_from_surface
    for number in range(DIRECTIONS):
        heading = start + 2 * math.pi * number / DIRECTIONS
        x, y = here.x + distance * math.cos(heading), here.y + distance * math.sin(heading)
        there = Pose2D(x, y, here.yaw - turn)
        told = _at(surface, there)
        if all(_free(one, told) for one in bare):
            return told, tuple(
                _drawn(one, empty, surface, told) for one, empty in zip(maps, bare, strict=True)
            )
    raise FaultError(f"{fault.name}: nothing on the floor plan is free {distance:g} m from {name}")


def _at(surface: Surface, map_from_surface: Pose2D) -> Surface:
    """The surface with what hangs over it at another place."""
    motion = map_from_surface @ surface.map_from_surface.inverse()
    over = tuple(
        replace(one, map_from_overhang=motion @ one.map_from_overhang) for one in surface.over
    )
    return replace(surface, map_from_surface=map_from_surface, over=over)


def _inside(picture: MapPicture, surface: Surface) -> NDArray[np.bool_]:
    """Which pixels (rows, columns) show the surface."""
    x, y = _own(picture, surface.map_from_surface)
    half_x, half_y = (edge / 2 + DRAWN for edge in surface.size)
    return np.asarray((np.abs(x) <= half_x) & (np.abs(y) <= half_y))


def _own(picture: MapPicture, frame: Pose2D) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """x and y (rows, columns) of the middle of each pixel in a frame of the map, m."""
    rows, columns = np.indices(picture.levels.shape)
    x = picture.origin[0] + (columns + 0.5) * picture.resolution - frame.x
    y = picture.origin[1] + (len(picture.levels) - rows - 0.5) * picture.resolution - frame.y
    c, s = math.cos(frame.yaw), math.sin(frame.yaw)
    return c * x + s * y, c * y - s * x


def _without(picture: MapPicture, surface: Surface) -> MapPicture:
    levels = picture.levels.copy()
    levels[picture.occupied() & _inside(picture, surface)] = picture.free_level
    return replace(picture, levels=levels)


def _free(picture: MapPicture, surface: Surface) -> bool:
    """Whether the surface lies on the map, and nothing else is drawn there."""
    inside = _inside(picture, surface)
    area = (surface.size[0] + 2 * DRAWN) * (surface.size[1] + 2 * DRAWN)
    whole = inside.sum() * picture.resolution**2 > 0.9 * area
    return bool(whole and not (picture.occupied() & inside).any())


def _drawn(picture: MapPicture, bare: MapPicture, here: Surface, there: Surface) -> MapPicture:
    """`bare` with the pixels of `picture` that show the surface, moved along with it."""
    x, y = _own(picture, there.map_from_surface)
    at = here.map_from_surface
    c, s = math.cos(at.yaw), math.sin(at.yaw)
    column = (at.x + c * x - s * y - picture.origin[0]) / picture.resolution
    above = (at.y + s * x + c * y - picture.origin[1]) / picture.resolution
    rows = len(picture.levels) - 1 - np.floor(above).astype(np.int64)
    columns = np.floor(column).astype(np.int64)
    height, width = picture.levels.shape
    copied = _inside(picture, there) & (rows >= 0) & (rows < height)
    copied &= (columns >= 0) & (columns < width)
    levels, was = bare.levels.copy(), picture.occupied()
    copied[copied] = was[rows[copied], columns[copied]]
    levels[copied] = picture.levels[rows[copied], columns[copied]]
    return replace(bare, levels=levels)

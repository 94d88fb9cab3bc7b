"""A floor plan to look at: with the way driven, and the names that were taught."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from momantu_bt.geometry import Array, Pose2D
from momantu_bt.lazy import lazily
from momantu_bt.site_file import Names, TaughtSurface
from momantu_skills.mapping.pictures.raster import known_part, resampled
from momantu_skills.navigation.map.maps import GridMap

with lazily():
    from momantu_skills.mapping.pictures import sheet

COLORS = np.array([(254, 254, 254), (0, 0, 0), (205, 205, 205)], dtype=np.uint8)
"""Of FREE, OCCUPIED and UNKNOWN."""
WAY = (200, 60, 40)
START, END = (40, 140, 60), (40, 80, 200)
NAMED = (150, 60, 150)
JUMP = 3.0
"""Distance between two scans above which no way is drawn between them, m: a session began."""
_KEY = {"occupied": (0, 0, 0), "free": (254, 254, 254), "unknown": (205, 205, 205)}


def floor_plan_png(grid: GridMap, way: Sequence[Pose2D] = (), names: Names | None = None) -> bytes:
    """A PNG of the known part of a map. way: poses driven, green at the start, blue at the end."""
    part = known_part(grid)
    rows, columns = sheet.pixels_of((part.cells.shape[0], part.cells.shape[1]))
    colors = COLORS[resampled(part.cells, rows, columns)]
    key = [(color, text) for text, color in _KEY.items()]
    if way:
        key += [(WAY, "way"), (START, "its start"), (END, "its end")]
    if names is not None and (names.places or names.surfaces):
        key += [(NAMED, "names")]
    drawn = sheet.Sheet(colors, part.size, part.origin, key)
    if names is not None:
        _draw_names(drawn, names)
    if way:
        for drive in _unbroken(way):
            drawn.line(np.array([(pose.x, pose.y) for pose in drive]), WAY)
        drawn.dot(way[0].x, way[0].y, START)
        drawn.dot(way[-1].x, way[-1].y, END)
    if names is not None:
        for pose in names.places.values():
            drawn.arrow(Pose2D(*pose), NAMED)
    return drawn.png()


def _unbroken(way: Sequence[Pose2D]) -> list[list[Pose2D]]:
    """The parts of a way between jumps."""
    parts = [[way[0]]]
    for before, pose in itertools.pairwise(way):
        if before.distance_to(pose) > JUMP:
            parts.append([])
        parts[-1].append(pose)
    return parts


def _draw_names(drawn: sheet.Sheet, names: Names) -> None:
    """Surfaces and all words; the way and places lie over them."""
    for surface in names.surfaces.values():
        drawn.outline(_outline(surface), NAMED)
    for name, (x, y, _) in names.places.items():
        drawn.word(name, x, y, NAMED)
    for name, surface in names.surfaces.items():
        drawn.word(name, surface.centre[0], surface.centre[1], NAMED)


def _outline(surface: TaughtSurface) -> Array:
    """The corners (n, 2) of a surface's top in the map."""
    half = np.array(surface.size) / 2
    if surface.round:
        turns = np.linspace(0.0, math.tau, 24, endpoint=False)
        flat = np.column_stack([np.cos(turns), np.sin(turns)]) * half
    else:
        flat = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half
    return Pose2D(*surface.centre).apply(flat)

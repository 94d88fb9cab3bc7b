"""Boxes: the shortest edge along x, the longest along z."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from momantu_bt.geometry import Transform
from momantu_worlds.labelled.shape import Draw, Maker, Shape
from momantu_worlds.labelled.sweeps import rounded_block
from momantu_worlds.scenes.catalogue.paint import Look
from momantu_worlds.scenes.geometry.bodies import Part
from momantu_worlds.scenes.geometry.parts import block, shade


def _edges(draw: Draw) -> tuple[float, float, float]:
    """Edges of a box, m; the shortest along x, the longest along z."""
    x, y, z = sorted(draw.uniform((0.03, 0.05, 0.07), (0.08, 0.13, 0.22)).tolist())
    return x, y, z


def _boxed(size: tuple[float, float, float], parts: tuple[Part, ...]) -> Shape:
    half = np.array(size) / 2
    corners = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T * half
    return Shape("", "", size, parts, corners, None)


def _carton(draw: Draw, look: Look) -> Shape:
    x, y, z = _edges(draw)
    parts = [block((x, y, z), (0, 0, 0), look.color)]
    for band in look.bands:
        paper = (x + 0.0006, y + 0.0006, (band.high - band.low) * z)
        parts.append(block(paper, (0, 0, ((band.low + band.high) / 2 - 0.5) * z), band.color))
    if look.label is not None:
        high = (look.label.high - look.label.low) * z
        parts.append(block((x + 0.001, 0.8 * y, high), (0, 0, 0), look.label.color))
    return _boxed((x, y, z), tuple(parts))


def _brick(draw: Draw, look: Look) -> Shape:
    x, y, z = _edges(draw)
    side = look.trim
    parts = (
        block((x, y, z), (0, 0, 0), look.color),
        block((x + 0.0006, 0.9 * y, 0.9 * z), (0, 0, 0), side),
    )
    return _boxed((x, y, z), parts)


def _rounded(draw: Draw, look: Look) -> Shape:
    """Testing: a box with round edges along z."""
    size = _edges(draw)
    edge = draw.uniform(0.1, 0.22) * size[0]
    return _boxed(size, (Part(rounded_block(size, edge), Transform(), look.color),))


def _lidded(draw: Draw, look: Look) -> Shape:
    """Testing: a box with a lid that is wider than it."""
    x, y, z = _edges(draw)
    lid = draw.uniform(0.2, 0.35) * z
    parts = (
        block((x - 0.004, y - 0.004, z), (0, 0, 0), look.color),
        block((x, y, lid), (0, 0, (z - lid) / 2), shade(look.trim, 0.9)),
    )
    return _boxed((x, y, z), parts)


TRAINING: Mapping[str, Maker] = {"carton": _carton, "brick": _brick}
"""The families that are trained on."""
TESTING: Mapping[str, Maker] = {"rounded": _rounded, "lidded": _lidded}
"""The families that are never trained on."""

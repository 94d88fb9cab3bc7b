"""Mugs: a handle lies towards +x and does not count in the size."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_worlds.labelled.shape import Draw, Line, Maker, Shape, curve, turned
from momantu_worlds.labelled.sweeps import tube
from momantu_worlds.scenes.catalogue.paint import Look
from momantu_worlds.scenes.geometry.bodies import Part


def _mug(draw: Draw) -> tuple[float, float]:
    """Radius and height of a mug, m."""
    radius = draw.uniform(0.033, 0.05)
    return radius, radius * draw.uniform(1.7, 2.6)


def _with_handle(outside: Line, look: Look, path: Array, thick: tuple[float, float]) -> Shape:
    """A mug. path: of the handle's middle, points (n, 2) outwards from the axis and up, m."""
    color = look.trim if len(look.bands) % 2 else look.color
    line = np.column_stack([path[:, 0], np.zeros(len(path)), path[:, 1]])
    handle = Part(tube(line, *thick), Transform(), color, collision=False)
    wall, base = 0.004, 0.007
    inner = [(r - wall, max(z, base)) for r, z in reversed(outside)] + [(0.0, base)]
    return turned([(0.0, 0.0), *outside], look, inner, more=(handle,))


def _bar(draw: Draw, r: float, h: float) -> Array:
    """A handle of three straight bars."""
    out = draw.uniform(0.02, 0.036)
    low, high = draw.uniform(0.18, 0.3) * h, draw.uniform(0.7, 0.88) * h
    return np.array([(r - 0.003, low), (r + out, low), (r + out, high), (r - 0.003, high)])


def _ring(draw: Draw, r: float, h: float) -> Array:
    """A handle like the letter C."""
    out, half, middle = draw.uniform(0.022, 0.038), draw.uniform(0.24, 0.34) * h, 0.52 * h
    turn = np.linspace(-math.pi / 2, math.pi / 2, 11)
    return np.column_stack([r - 0.003 + out * np.cos(turn), middle + half * np.sin(turn)])


def _ear(draw: Draw, r: float, h: float) -> Array:
    """Testing: a handle like an ear, wide above and pointed below."""
    out, low, high = draw.uniform(0.024, 0.038), 0.16 * h, 0.85 * h
    share = np.array([0.0, 0.6, 1.0, 0.95, 0.75, 0.45, 0.2, 0.0])
    return np.column_stack([r - 0.003 + out * share, np.linspace(high, low, 8)])


def _thick(draw: Draw) -> tuple[float, float]:
    """Half the width and half the thickness of a handle, m."""
    return draw.uniform(0.004, 0.008), draw.uniform(0.003, 0.006)


def _bar_mug(draw: Draw, look: Look) -> Shape:
    r, h = _mug(draw)
    return _with_handle([(r, 0.0), (r, h)], look, _bar(draw, r, h), _thick(draw))


def _ring_mug(draw: Draw, look: Look) -> Shape:
    r, h = _mug(draw)
    return _with_handle([(r, 0.0), (r, h)], look, _ring(draw, r, h), _thick(draw))


def _tapered_mug(draw: Draw, look: Look) -> Shape:
    r, h = _mug(draw)
    side = [(draw.uniform(0.7, 0.9) * r, 0.0), (r, h)]
    path = _ring(draw, 0.93 * r, h) if draw.random() < 0.5 else _bar(draw, 0.93 * r, h)
    return _with_handle(side, look, path, _thick(draw))


def _round_mug(draw: Draw, look: Look) -> Shape:
    r, h = _mug(draw)
    side = curve((0.6 * r, 0.0), (r, 0.45 * h), 0.2)
    return _with_handle([*side, (r, h)], look, _ring(draw, r, h), _thick(draw))


def _barrel_mug(draw: Draw, look: Look) -> Shape:
    """Testing: it swells in its middle and has an ear."""
    r, h = _mug(draw)
    side = curve((0.85 * r, 0.0), (0.85 * r, h), 0.15 * r / h)
    return _with_handle(side, look, _ear(draw, 0.93 * r, h), _thick(draw))


def _ear_mug(draw: Draw, look: Look) -> Shape:
    """Testing: a straight one with an ear."""
    r, h = _mug(draw)
    return _with_handle([(r, 0.0), (r, h)], look, _ear(draw, r, h), _thick(draw))


TRAINING: Mapping[str, Maker] = {
    "bar": _bar_mug,
    "ring": _ring_mug,
    "tapered": _tapered_mug,
    "round": _round_mug,
}
"""The families that are trained on."""
TESTING: Mapping[str, Maker] = {"barrel": _barrel_mug, "ear": _ear_mug}
"""The families that are never trained on."""

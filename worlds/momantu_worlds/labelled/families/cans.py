"""Cans: round, closed, and alike at both ends."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from momantu_worlds.labelled.shape import Draw, Line, Maker, Shape, turned
from momantu_worlds.scenes.catalogue.paint import Look


def _can(draw: Draw) -> tuple[float, float]:
    """Radius and height of a can, m."""
    return draw.uniform(0.025, 0.05), draw.uniform(0.06, 0.18)


def _tin(draw: Draw, look: Look) -> Shape:
    r, h = _can(draw)
    rim = 0.003
    side = [(0.96 * r, 0.0), (r, rim), (r, h - rim), (0.96 * r, h)]
    return turned([(0.0, 0.0), *side], look, straight=True)


def _drink(draw: Draw, look: Look) -> Shape:
    r, h = _can(draw)
    h = max(h, 2.2 * r)
    end = draw.uniform(0.06, 0.1) * h
    side = [(0.8 * r, 0.0), (r, 0.6 * end), (r, h - end), (0.82 * r, h)]
    return turned([(0.0, 0.0), *side], look)


def _paint_tin(draw: Draw, look: Look) -> Shape:
    r, h = _can(draw)
    side = [(r, 0.0), (r, h), (0.9 * r, h), (0.9 * r, h - 0.004)]
    return turned([(0.0, 0.0), *side], look, [(0.0, h - 0.004)], straight=True)


def _ribbed(draw: Draw, look: Look) -> Shape:
    """Testing: ribs around its side."""
    r, h = _can(draw)
    side: Line = [(r, 0.0), (r, 0.15 * h)]
    for z in np.linspace(0.2, 0.8, 7).tolist():
        side += [(0.96 * r, z * h), (r, (z + 0.05) * h)]
    return turned([(0.0, 0.0), *side, (r, h)], look)


def _tapered_can(draw: Draw, look: Look) -> Shape:
    """Testing: a little narrower at one end, with a rolled rim."""
    r, h = _can(draw)
    low = draw.uniform(0.88, 0.94) * r
    side = [(low, 0.0), (0.97 * r, h - 0.008), (r, h - 0.006), (r, h)]
    return turned([(0.0, 0.0), *side], look)


TRAINING: Mapping[str, Maker] = {"tin": _tin, "drink": _drink, "paint_tin": _paint_tin}
"""The families that are trained on."""
TESTING: Mapping[str, Maker] = {"ribbed": _ribbed, "tapered": _tapered_can}
"""The families that are never trained on."""

"""Bowls: hollow, wider than high."""

from __future__ import annotations

from collections.abc import Mapping

from momantu_worlds.labelled.shape import Draw, Line, Maker, Shape, curve, turned
from momantu_worlds.scenes.catalogue.paint import Look


def _walled(outside: Line, look: Look, wall: float, base: float) -> Shape:
    """A hollow thing with a wall of that thickness and a bottom of thickness `base`, m."""
    inner = [(max(0.0, r - wall), max(z, base)) for r, z in reversed(outside)]
    inside = [point for point in inner if point[0] > 0.0] + [(0.0, base)]
    return turned([(0.0, 0.0), *outside], look, inside)


def _bowl(draw: Draw) -> tuple[float, float, float]:
    """Radius, height and foot's radius of a bowl, m."""
    radius = draw.uniform(0.055, 0.10)
    return radius, radius * draw.uniform(0.55, 0.95), radius * draw.uniform(0.35, 0.55)


def _round_bowl(draw: Draw, look: Look) -> Shape:
    r, h, foot = _bowl(draw)
    return _walled(curve((foot, 0.0), (r, h), draw.uniform(0.12, 0.2)), look, 0.004, 0.007)


def _conical_bowl(draw: Draw, look: Look) -> Shape:
    r, h, foot = _bowl(draw)
    return _walled([(foot, 0.0), (r, h)], look, 0.004, 0.006)


def _footed_bowl(draw: Draw, look: Look) -> Shape:
    r, h, foot = _bowl(draw)
    ring = 0.1 * h
    return _walled(
        [(foot, 0.0), (foot, ring), *curve((foot, ring), (r, h), 0.15)], look, 0.005, ring + 0.005
    )


def _bent_bowl(draw: Draw, look: Look) -> Shape:
    r, h, foot = _bowl(draw)
    return _walled([(foot, 0.0), (0.82 * r, 0.45 * h), (r, h)], look, 0.005, 0.008)


def _lipped_bowl(draw: Draw, look: Look) -> Shape:
    """Testing: a round bowl with a lip that turns outwards."""
    r, h, foot = _bowl(draw)
    side = curve((foot, 0.0), (0.84 * r, 0.85 * h), 0.17)
    return _walled([*side, (r, h)], look, 0.004, 0.007)


def _tulip_bowl(draw: Draw, look: Look) -> Shape:
    """Testing: first steep, then hollow, as a tulip's flower."""
    r, h, foot = _bowl(draw)
    side = [
        *curve((foot, 0.0), (0.72 * r, 0.5 * h), 0.18),
        *curve((0.72 * r, 0.5 * h), (r, h), -0.1),
    ]
    return _walled(side, look, 0.004, 0.007)


TRAINING: Mapping[str, Maker] = {
    "round": _round_bowl,
    "conical": _conical_bowl,
    "footed": _footed_bowl,
    "bent": _bent_bowl,
}
"""The families that are trained on."""
TESTING: Mapping[str, Maker] = {"lipped": _lipped_bowl, "tulip": _tulip_bowl}
"""The families that are never trained on."""

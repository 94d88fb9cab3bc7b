"""Bottles: a body, a shoulder, a neck and a cap."""

from __future__ import annotations

from collections.abc import Mapping

from momantu_worlds.labelled.shape import Draw, Line, Maker, Shape, curve, s_curve, turned
from momantu_worlds.scenes.catalogue.paint import Look


def _topped(side: Line, neck: float, high: float, look: Look, straight: bool) -> Shape:
    """A bottle whose side ends at the neck; a cap as wide as the neck or a little wider."""
    cap = 1.0 + 0.12 * (len(look.bands) % 2)
    start = side[-1][1]
    top = [(neck * cap, start), (neck * cap, high)]
    return turned([(0.0, 0.0), *side, *top], look, straight=straight)


def _bottle(draw: Draw) -> tuple[float, float, float]:
    """Radius, height and neck's radius of a bottle, m."""
    radius = draw.uniform(0.025, 0.045)
    return radius, draw.uniform(0.14, 0.30), radius * draw.uniform(0.28, 0.5)


def _shouldered(draw: Draw, look: Look) -> Shape:
    r, h, neck = _bottle(draw)
    low = h * draw.uniform(0.5, 0.75)
    up = low + h * draw.uniform(0.05, 0.15)
    return _topped([(r, 0.0), (r, low), (neck, up), (neck, 0.9 * h)], neck, h, look, True)


def _round_shouldered(draw: Draw, look: Look) -> Shape:
    r, h, neck = _bottle(draw)
    low = h * draw.uniform(0.45, 0.7)
    up = low + h * draw.uniform(0.1, 0.2)
    side = [(r, 0.0), *curve((r, low), (neck, up), 0.2), (neck, 0.92 * h)]
    return _topped(side, neck, h, look, True)


def _conical_bottle(draw: Draw, look: Look) -> Shape:
    r, h, neck = _bottle(draw)
    low = h * draw.uniform(0.2, 0.4)
    return _topped([(r, 0.0), (r, low), (neck, 0.85 * h)], neck, h, look, False)


def _waisted(draw: Draw, look: Look) -> Shape:
    r, h, neck = _bottle(draw)
    top = h * draw.uniform(0.55, 0.65)
    side = [(r, 0.0), *curve((r, 0.12 * h), (r, top), -draw.uniform(0.03, 0.07))]
    return _topped([*side, (neck, 0.82 * h)], neck, h, look, False)


def _sloping(draw: Draw, look: Look) -> Shape:
    """Testing: a long S from body to neck, as of Burgundy."""
    r, h, neck = _bottle(draw)
    low = h * draw.uniform(0.35, 0.5)
    return _topped([(r, 0.0), *s_curve((r, low), (neck, 0.8 * h))], neck, h, look, True)


def _barrel_bottle(draw: Draw, look: Look) -> Shape:
    """Testing: a body that swells in its middle, with a short neck."""
    r, h, neck = _bottle(draw)
    top = h * draw.uniform(0.6, 0.72)
    side = curve((0.85 * r, 0.0), (0.85 * r, top), 0.15 * r / top)
    return _topped([*side, (neck, top + 0.1 * h), (neck, 0.92 * h)], neck, h, look, False)


TRAINING: Mapping[str, Maker] = {
    "shouldered": _shouldered,
    "round_shouldered": _round_shouldered,
    "conical": _conical_bottle,
    "waisted": _waisted,
}
"""The families that are trained on."""
TESTING: Mapping[str, Maker] = {"sloping": _sloping, "barrel": _barrel_bottle}
"""The families that are never trained on."""

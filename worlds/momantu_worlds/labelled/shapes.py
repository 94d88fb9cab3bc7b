"""Shapes of five categories from parametric families, some of which are kept for testing.

Every shape's origin is the centre of its box; z is the axis of round ones. A mug's handle lies
towards +x and does not count in its size.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TypeAlias

import numpy as np

from momantu_bt.categories import USUAL
from momantu_bt.geometry import Array, Transform
from momantu_worlds.labelled.sweeps import rounded_block, tube
from momantu_worlds.scenes.catalogue.paint import Band, Look, label, painted, seen
from momantu_worlds.scenes.geometry.bodies import Color, Part
from momantu_worlds.scenes.geometry.parts import block, shade

CATEGORIES = tuple(USUAL)
"""All categories, in the order in which they are drawn."""

Draw: TypeAlias = np.random.Generator
Line: TypeAlias = list[tuple[float, float]]
Maker: TypeAlias = Callable[[Draw, Look], "Shape"]


@dataclass(frozen=True, slots=True)
class Shape:
    """One thing. size: extent (3,) along x, y, z, m, without a handle.

    outline: points (n, 3) around which its convex hull lies. profile: (k, 2) radius and height of
    a round one's outside; None of others. lying: turns (3, 3) in which a mesh lies.
    """

    category: str
    family: str
    size: tuple[float, float, float]
    parts: tuple[Part, ...]
    outline: Array
    profile: Array | None
    lying: tuple[Array, ...] = ()


def draw_shape(category: str, draw: Draw, *, testing: bool) -> Shape:
    """A shape of a random family. testing: of those that are never trained on."""
    kinds = FAMILIES[category][testing]
    family = list(kinds)[int(draw.integers(len(kinds)))]
    shape = kinds[family](draw, draw_look(draw))
    return replace(shape, category=category, family=family)


def draw_color(draw: Draw) -> Color:
    """A colour of any hue, often a pale or a dark one."""
    hue, full, bright = draw.random(3)
    full *= full if draw.random() < 0.5 else 1.0
    wheel = np.clip(np.abs((6.0 * hue + np.array([0.0, 4.0, 2.0])) % 6.0 - 3.0) - 1.0, 0.0, 1.0)
    red, green, blue = ((0.1 + 0.88 * bright) * (1.0 - full + full * wheel)).tolist()
    return red, green, blue


def draw_look(draw: Draw) -> Look:
    """Paint with up to three bands, and sometimes a label."""
    body = draw_color(draw)
    bands = []
    for _ in range(int(draw.integers(4)) if draw.random() < 0.6 else 0):
        low = draw.uniform(0.0, 0.85)
        bands.append(Band(low, min(1.0, low + draw.uniform(0.05, 0.5)), draw_color(draw)))
    sheet = None
    if draw.random() < 0.3:
        low = draw.uniform(0.1, 0.35)
        sheet = Band(low, low + draw.uniform(0.15, 0.25), draw_color(draw))
    trim = body if draw.random() < 0.4 else draw_color(draw)
    return Look(body, trim, tuple(bands), sheet)


def turned(
    outside: Line,
    look: Look,
    inside: Sequence[tuple[float, float]] = (),
    *,
    more: tuple[Part, ...] = (),
    straight: bool = False,
) -> Shape:
    """A thing turned around z. outside: (radius, height) from the axis at the bottom upwards.

    inside: a hollow one's inner side from the rim down to the axis; otherwise its top is closed.
    more: further parts, in the frame of the line. straight: a label may stick to its side.
    """
    high = max(z for _, z in outside)
    wide = max(r for r, _ in outside)
    closing = inside or [(0.0, outside[-1][1])]
    body = [*painted(outside, high, look), seen([outside[-1], *closing], look.trim)]
    if straight:
        body += label(wide, high, look)
    down = Transform((0.0, 0.0, -high / 2))
    parts = tuple(replace(p, body_from_part=down @ p.body_from_part) for p in (*body, *more))
    profile = np.array(outside) - (0.0, high / 2)
    turns = np.linspace(0.0, 2.0 * math.pi, 16, endpoint=False)
    ring = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    outline = np.concatenate([np.column_stack([ring * r, np.full(16, z)]) for r, z in profile])
    for part in more:
        points = getattr(part.geometry, "vertices", np.zeros((0, 3)))
        outline = np.concatenate([outline, points - (0.0, 0.0, high / 2)])
    return Shape("", "", (2 * wide, 2 * wide, high), parts, outline, profile)


def _curve(
    start: tuple[float, float], end: tuple[float, float], bulge: float, steps: int = 8
) -> Line:
    """Points from start to end, bent outwards by `bulge` of their distance (inwards below 0)."""
    (r0, z0), (r1, z1) = start, end
    way = math.hypot(r1 - r0, z1 - z0)
    out = ((z1 - z0) / max(way, 1e-9), -(r1 - r0) / max(way, 1e-9))
    found = []
    for t in np.linspace(0.0, 1.0, steps + 1).tolist():
        bend = 4.0 * t * (1.0 - t) * bulge * way
        found.append(
            (max(0.0, r0 + t * (r1 - r0) + bend * out[0]), z0 + t * (z1 - z0) + bend * out[1])
        )
    return found


def _s_curve(start: tuple[float, float], end: tuple[float, float], steps: int = 10) -> Line:
    """Points that leave start upwards and arrive at end upwards."""
    (r0, z0), (r1, z1) = start, end
    ease = [
        (t, (1.0 - math.cos(math.pi * t)) / 2) for t in np.linspace(0.0, 1.0, steps + 1).tolist()
    ]
    return [(r0 + e * (r1 - r0), z0 + t * (z1 - z0)) for t, e in ease]


# Bottles


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
    side = [(r, 0.0), *_curve((r, low), (neck, up), 0.2), (neck, 0.92 * h)]
    return _topped(side, neck, h, look, True)


def _conical_bottle(draw: Draw, look: Look) -> Shape:
    r, h, neck = _bottle(draw)
    low = h * draw.uniform(0.2, 0.4)
    return _topped([(r, 0.0), (r, low), (neck, 0.85 * h)], neck, h, look, False)


def _waisted(draw: Draw, look: Look) -> Shape:
    r, h, neck = _bottle(draw)
    top = h * draw.uniform(0.55, 0.65)
    side = [(r, 0.0), *_curve((r, 0.12 * h), (r, top), -draw.uniform(0.03, 0.07))]
    return _topped([*side, (neck, 0.82 * h)], neck, h, look, False)


def _sloping(draw: Draw, look: Look) -> Shape:
    """Testing: a long S from body to neck, as of Burgundy."""
    r, h, neck = _bottle(draw)
    low = h * draw.uniform(0.35, 0.5)
    return _topped([(r, 0.0), *_s_curve((r, low), (neck, 0.8 * h))], neck, h, look, True)


def _barrel_bottle(draw: Draw, look: Look) -> Shape:
    """Testing: a body that swells in its middle, with a short neck."""
    r, h, neck = _bottle(draw)
    top = h * draw.uniform(0.6, 0.72)
    side = _curve((0.85 * r, 0.0), (0.85 * r, top), 0.15 * r / top)
    return _topped([*side, (neck, top + 0.1 * h), (neck, 0.92 * h)], neck, h, look, False)


# Bowls


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
    return _walled(_curve((foot, 0.0), (r, h), draw.uniform(0.12, 0.2)), look, 0.004, 0.007)


def _conical_bowl(draw: Draw, look: Look) -> Shape:
    r, h, foot = _bowl(draw)
    return _walled([(foot, 0.0), (r, h)], look, 0.004, 0.006)


def _footed_bowl(draw: Draw, look: Look) -> Shape:
    r, h, foot = _bowl(draw)
    ring = 0.1 * h
    return _walled(
        [(foot, 0.0), (foot, ring), *_curve((foot, ring), (r, h), 0.15)], look, 0.005, ring + 0.005
    )


def _bent_bowl(draw: Draw, look: Look) -> Shape:
    r, h, foot = _bowl(draw)
    return _walled([(foot, 0.0), (0.82 * r, 0.45 * h), (r, h)], look, 0.005, 0.008)


def _lipped_bowl(draw: Draw, look: Look) -> Shape:
    """Testing: a round bowl with a lip that turns outwards."""
    r, h, foot = _bowl(draw)
    side = _curve((foot, 0.0), (0.84 * r, 0.85 * h), 0.17)
    return _walled([*side, (r, h)], look, 0.004, 0.007)


def _tulip_bowl(draw: Draw, look: Look) -> Shape:
    """Testing: first steep, then hollow, as a tulip's flower."""
    r, h, foot = _bowl(draw)
    side = [
        *_curve((foot, 0.0), (0.72 * r, 0.5 * h), 0.18),
        *_curve((0.72 * r, 0.5 * h), (r, h), -0.1),
    ]
    return _walled(side, look, 0.004, 0.007)


# Cans


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


# Mugs


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
    side = _curve((0.6 * r, 0.0), (r, 0.45 * h), 0.2)
    return _with_handle([*side, (r, h)], look, _ring(draw, r, h), _thick(draw))


def _barrel_mug(draw: Draw, look: Look) -> Shape:
    """Testing: it swells in its middle and has an ear."""
    r, h = _mug(draw)
    side = _curve((0.85 * r, 0.0), (0.85 * r, h), 0.15 * r / h)
    return _with_handle(side, look, _ear(draw, 0.93 * r, h), _thick(draw))


def _ear_mug(draw: Draw, look: Look) -> Shape:
    """Testing: a straight one with an ear."""
    r, h = _mug(draw)
    return _with_handle([(r, 0.0), (r, h)], look, _ear(draw, r, h), _thick(draw))


# Boxes


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


FAMILIES: Mapping[str, tuple[Mapping[str, Maker], Mapping[str, Maker]]] = MappingProxyType(
    {
        "bottle": (
            {
                "shouldered": _shouldered,
                "round_shouldered": _round_shouldered,
                "conical": _conical_bottle,
                "waisted": _waisted,
            },
            {"sloping": _sloping, "barrel": _barrel_bottle},
        ),
        "bowl": (
            {
                "round": _round_bowl,
                "conical": _conical_bowl,
                "footed": _footed_bowl,
                "bent": _bent_bowl,
            },
            {"lipped": _lipped_bowl, "tulip": _tulip_bowl},
        ),
        "can": (
            {"tin": _tin, "drink": _drink, "paint_tin": _paint_tin},
            {"ribbed": _ribbed, "tapered": _tapered_can},
        ),
        "mug": (
            {"bar": _bar_mug, "ring": _ring_mug, "tapered": _tapered_mug, "round": _round_mug},
            {"barrel": _barrel_mug, "ear": _ear_mug},
        ),
        "box": (
            {"carton": _carton, "brick": _brick},
            {"rounded": _rounded, "lidded": _lidded},
        ),
    }
)
"""Category -> its families for training, and those for testing."""

"""A thing of known shape, and how one is turned, painted and drawn at random.

Every shape's origin is the centre of its box; z is the axis of round ones.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_worlds.scenes.catalogue.paint import Band, Look, label, painted, seen
from momantu_worlds.scenes.geometry.bodies import Color, Part

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


def curve(
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


def s_curve(start: tuple[float, float], end: tuple[float, float], steps: int = 10) -> Line:
    """Points that leave start upwards and arrive at end upwards."""
    (r0, z0), (r1, z1) = start, end
    ease = [
        (t, (1.0 - math.cos(math.pi * t)) / 2) for t in np.linspace(0.0, 1.0, steps + 1).tolist()
    ]
    return [(r0 + e * (r1 - r0), z0 + t * (z1 - z0)) for t, e in ease]

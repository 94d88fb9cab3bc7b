"""Loose objects of random sizes, weights and paint.

Two random streams: one draws the object, the other its paint, so that different paint never
changes the physics.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from momantu_worlds.scenes.catalogue.objects import METAL, ObjectKind, Thing
from momantu_worlds.scenes.catalogue.paint import Band, Look
from momantu_worlds.scenes.geometry.bodies import Color
from momantu_worlds.scenes.geometry.parts import shade

Size: TypeAlias = tuple[float, float, float]
Span: TypeAlias = tuple[float, float]

GRASPABLE = 0.080
"""m; an object whose narrower side is at most this wide fits usual grippers with room to spare."""
COLORS: tuple[Color, ...] = (
    (0.16, 0.42, 0.62),
    (0.20, 0.50, 0.30),
    (0.85, 0.70, 0.20),
    (0.80, 0.78, 0.74),
    (0.55, 0.25, 0.45),
    (0.30, 0.22, 0.18),
)
"""Colours of bodies."""
PAINTS: tuple[Color, ...] = (
    (0.92, 0.90, 0.84),
    (0.12, 0.14, 0.18),
    (0.78, 0.16, 0.14),
    (0.95, 0.55, 0.12),
    (0.10, 0.30, 0.55),
    (0.35, 0.60, 0.25),
)
"""Colours of bands, labels, caps and insides."""
LACQUERS: tuple[Color, ...] = (METAL, (0.80, 0.68, 0.36), (0.15, 0.15, 0.16))
"""Ends of cans: bare metal, golden, black."""


@dataclass(frozen=True, slots=True)
class Make:
    """Usual values of a round kind. radius and height: m. mass: of a medium-sized one, kg."""

    radius: Span
    height: Span
    mass: Span

    def bulk(self, radius: float, height: float, *, hollow: bool) -> float:
        """Its wall's area (hollow) or volume, as a share of that of one of middle size."""
        wide, high = radius / (sum(self.radius) / 2), height / (sum(self.height) / 2)
        return wide * high if hollow else wide * wide * high


ROUND: dict[ObjectKind, Make] = {
    "can": Make((0.026, 0.042), (0.085, 0.170), (0.25, 0.45)),
    "bottle": Make((0.030, 0.038), (0.20, 0.26), (0.3, 0.6)),
    "mug": Make((0.038, 0.045), (0.085, 0.100), (0.25, 0.40)),
    "bowl": Make((0.060, 0.080), (0.050, 0.070), (0.20, 0.40)),
}
"""Tins and drinks, full or not; small bottles likewise; porcelain with walls of 5 mm."""
HOLLOW: frozenset[ObjectKind] = frozenset({"mug", "bowl"})
PACKET: tuple[Span, Span, Span] = ((0.05, 0.1), (0.06, 0.16), (0.06, 0.2))
"""m; edges of packets of food: depth, width, height."""
PACKET_DENSITY, PACKET_CARTON = 250.0, 0.05
"""kg/m3 of the food and kg of its carton: dry food is loose, and the carton has weight too."""


def draw_thing(
    kind: ObjectKind,
    draw: np.random.Generator,
    paint: np.random.Generator | None = None,
    *,
    size: Size | None = None,
    color: Color | None = None,
    graspable: bool = False,
) -> Thing:
    """A thing of the kind; size and color are drawn unless given.

    paint: draws its pattern; None: the usual one of its kind. graspable: see `draw_size`.
    """
    body = COLORS[int(draw.integers(len(COLORS)))] if color is None else color
    size = draw_size(kind, draw, graspable=graspable) if size is None else size
    look = None if paint is None else draw_look(kind, body, paint)
    return Thing(kind, size, draw_mass(kind, size, draw), body, look)


def draw_size(kind: ObjectKind, draw: np.random.Generator, *, graspable: bool = False) -> Size:
    """Edges (x, y, z) of a thing of the kind, m.

    graspable: it is at most GRASPABLE wide along x, as far as its kind allows; bowls never are.
    """
    if kind == "box":
        x, y, z = (float(draw.uniform(*span)) for span in PACKET)
        return min(x, GRASPABLE) if graspable else x, y, z
    make = ROUND[kind]
    low, high = make.radius
    if graspable:
        high = max(low, min(high, GRASPABLE / 2))
    radius, height = float(draw.uniform(low, high)), float(draw.uniform(*make.height))
    return 2 * radius, 2 * radius, height


def draw_mass(kind: ObjectKind, size: Size, draw: np.random.Generator) -> float:
    """kg; a larger one of its kind is heavier."""
    if kind == "box":
        return PACKET_DENSITY * size[0] * size[1] * size[2] + PACKET_CARTON
    make = ROUND[kind]
    return float(draw.uniform(*make.mass)) * make.bulk(size[0] / 2, size[2], hollow=kind in HOLLOW)


def draw_look(kind: ObjectKind, color: Color, paint: np.random.Generator) -> Look:
    """One of the patterns that things of the kind have."""
    one, other = (PAINTS[i] for i in paint.choice(len(PAINTS), 2, replace=False).tolist())
    if kind in HOLLOW:
        return _glazed(color, one, paint)
    if kind == "can":
        trim = LACQUERS[int(paint.integers(len(LACQUERS)))]
        return _wrapped(Look(color, trim), (0.06, 0.94), one, other, paint)
    if kind == "bottle":
        trim = other if paint.random() < 0.5 else shade(color, 0.5)
        return _wrapped(Look(color, trim), (0.10, 0.56), one, other, paint)
    return _wrapped(Look(color, color), (0.0, 1.0), one, other, paint)


def _wrapped(bare: Look, side: Span, one: Color, other: Color, paint: np.random.Generator) -> Look:
    """No paint, a wrapper, stripes, an edge of another colour, or a label on one side.

    side: shares of the height between which there is room for paint.
    """
    low, high = side
    room = high - low
    at = low + room * float(paint.uniform(0.1, 0.5))
    deep = room * float(paint.uniform(0.15, 0.4))
    bands = (
        (),
        (Band(at, at + deep, one),),
        (Band(at, at + deep, one), Band(at + 0.3 * deep, at + 0.5 * deep, other)),
        tuple(Band(low + s * room, low + (s + 0.1) * room, one) for s in (0.15, 0.45, 0.75)),
        (Band(low + 0.8 * room, high, one),),
        (),
    )
    pattern = int(paint.integers(len(bands)))
    label = Band(low + 0.2 * room, low + 0.75 * room, one) if pattern == len(bands) - 1 else None
    return Look(bare.color, bare.trim, bands[pattern], label)


def _glazed(color: Color, one: Color, paint: np.random.Generator) -> Look:
    """One glaze, another inside, a rim, a foot, or stripes."""
    patterns = (
        Look(color, color),
        Look(color, one),
        Look(color, color, (Band(0.88, 1.0, one),)),
        Look(color, one, (Band(0.0, 0.35, one),)),
        Look(color, color, (Band(0.3, 0.42, one), Band(0.54, 0.66, one))),
    )
    return patterns[int(paint.integers(len(patterns)))]

"""Loose objects for tables: can, bottle, box, mug, bowl. Each stands on z = 0 around its origin.

One that lies is the same body, put down on its side.

The visible shape is a lathe surface. The colliding shape consists of cylinders, boxes and convex
pieces, is hollow where the object is, and lies within 2 mm of the visible one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal, TypeAlias, get_args

from momantu_bt.geometry import Transform
from momantu_worlds.scenes.catalogue.lathe import sectors, shell_pieces, solid_piece
from momantu_worlds.scenes.catalogue.paint import PAPER, Band, Look, label, painted, seen
from momantu_worlds.scenes.geometry.bodies import Box, Color, Cylinder, Geometry, Part
from momantu_worlds.scenes.geometry.parts import block, shade

ObjectKind: TypeAlias = Literal["bottle", "box", "mug", "bowl", "can"]
OBJECT_KINDS: tuple[ObjectKind, ...] = get_args(ObjectKind)
LYING_KINDS: tuple[ObjectKind, ...] = ("bottle", "can")
"""Kinds that rest on their side with a level axis."""

METAL: Color = (0.72, 0.73, 0.75)
WALL = 0.005
"""m; thickness of a mug's or bowl's wall."""
BASE = 0.011
"""m; thickness of a hollow object's bottom. Only this solid disc touches the table, so a resting
object costs the physics one pair of shapes; the wall begins above the reach of contacts."""
CHAMFER = 0.0021
"""m; most that a can's ends are drawn in, as the whole cylinder collides."""


@dataclass(frozen=True, slots=True)
class Thing:
    """A kind of object with its sizes.

    radius: of the circle around everything that sticks out, m; height: m; mass: kg.
    size: (3,) the box's edges, or (2 radius, 2 radius, height) of the round body alone.
    look: its paint; None: the usual one of its kind, in `color`. lying: it lies on its side.
    mesh: what it is made of instead, with the foot's middle at the origin.
    """

    kind: ObjectKind
    size: tuple[float, float, float]
    mass: float
    color: Color
    look: Look | None = None
    lying: bool = False
    mesh: tuple[Part, ...] = ()

    @property
    def height(self) -> float:
        """m, from the table to its top."""
        return self.size[0] if self.lying else self.size[2]

    @property
    def rest(self) -> Transform:
        """`place_from_body`: how it is put down at a place, with its axis along x if it lies."""
        if not self.lying:
            return Transform((0.0, 0.0, 0.0))
        centre = (-self.size[2] / 2, 0.0, self.size[0] / 2)
        return Transform.from_rpy(centre, (0.0, math.pi / 2, 0.0))

    @property
    def reach(self) -> float:
        """Radius of the upright cylinder around it, handles included, m."""
        if self.lying:
            return math.hypot(self.size[0], self.size[2]) / 2
        if self.kind == "box" or self.mesh:
            return math.hypot(self.size[0], self.size[1]) / 2
        return self.size[0] / 2 + (_handle(self.size[2]) if self.kind == "mug" else 0.0)

    def parts(self) -> tuple[Part, ...]:
        """What it is made of."""
        if self.mesh:
            return self.mesh
        makers = {"can": _can, "bottle": _bottle, "box": _box, "mug": _mug, "bowl": _bowl}
        return makers[self.kind](self, self.look or usual_look(self.kind, self.color))


def usual_look(kind: ObjectKind, color: Color) -> Look:
    """The paint of a thing of which only the colour is told."""
    if kind == "can":
        return Look(color, METAL, (Band(0.55, 0.70, (0.92, 0.90, 0.84)),))
    if kind == "bottle":
        return Look(color, shade(color, 0.5), (Band(0.15, 0.45, (0.90, 0.88, 0.80)),))
    if kind == "box":
        return Look(color, shade(color, 0.7), (Band(0.8, 1.0, shade(color, 0.7)),))
    return Look(color, color)


def _touch(geometry: Geometry, z: float = 0.0) -> Part:
    return Part(geometry, Transform((0, 0, z)), visual=False)


def _can(thing: Thing, look: Look) -> tuple[Part, ...]:
    r, h = thing.size[0] / 2, thing.size[2]
    rim, inside = 0.004, max(0.94 * r, r - CHAMFER)
    low, high = 0.02 * h + rim, 0.98 * h - rim
    return (
        seen([(0.0, 0.0), (inside, 0.0), (r, rim), (r, low)], look.trim),
        *painted([(r, low), (r, high)], h, look),
        seen([(r, high), (r, h - rim), (inside, h), (0.0, h)], look.trim),
        *label(r, h, look),
        _touch(Cylinder(r, h), h / 2),
    )


def _bottle(thing: Thing, look: Look) -> tuple[Part, ...]:
    r, h = thing.size[0] / 2, thing.size[2]
    neck, shoulder, base = 0.38 * r, 0.62 * h, 0.78 * h
    side = [(0.0, 0.0), (r, 0.0), (r, shoulder), (neck, base), (neck, 0.92 * h)]
    return (
        *painted(side, h, look),
        seen([(neck, 0.92 * h), (1.1 * neck, 0.92 * h), (1.1 * neck, h), (0.0, h)], look.trim),
        *label(r, h, look),
        _touch(Cylinder(r, shoulder), shoulder / 2),
        _touch(solid_piece([(r, shoulder), (neck, base)])),
        _touch(Cylinder(1.1 * neck, h - base), (h + base) / 2),
    )


def _box(thing: Thing, look: Look) -> tuple[Part, ...]:
    x, y, z = thing.size
    edges = sorted({0.0, 1.0, *(edge for band in look.bands for edge in (band.low, band.high))})
    slabs = [
        _sight(block((x, y, (high - low) * z), (0, 0, (low + high) / 2 * z), look.at(low)))
        for low, high in pairwise(edges)
    ]
    if look.label is not None:
        low, high = look.label.low * z, look.label.high * z
        sheet = (x + 2 * PAPER, 0.8 * y, high - low)
        slabs.append(_sight(block(sheet, (0, 0, (low + high) / 2), look.label.color)))
    return (*slabs, _touch(Box(thing.size), z / 2))


def _sight(part: Part) -> Part:
    """The part to look at alone."""
    return replace(part, collision=False)


def _handle(height: float) -> float:
    return 0.35 * height


def _mug(thing: Thing, look: Look) -> tuple[Part, ...]:
    r, h = thing.size[0] / 2, thing.size[2]
    hole, floor, out = r - WALL, BASE, _handle(thing.size[2])
    bar, low, high = 0.010, 0.25 * h, 0.80 * h
    # the bars reach into the wall, so that no gap is visible
    middle = r + (out - bar) / 2
    handle = (
        block((out, bar, bar), (middle, 0, low), look.color),
        block((out, bar, bar), (middle, 0, high), look.color),
        block((bar, bar, high - low + bar), (r + out - bar / 2, 0, (low + high) / 2), look.color),
    )
    wall = shell_pieces([(r, floor), (r, h)], [(hole, floor), (hole, h)], sectors(r))
    return (
        *painted([(0.0, 0.0), (r, 0.0), (r, h), (hole, h)], h, look),
        seen([(hole, h), (hole, floor), (0.0, floor)], look.trim),
        *handle,
        _touch(Cylinder(r, floor), floor / 2),
        *(_touch(piece) for piece in wall),
    )


def _bowl(thing: Thing, look: Look) -> tuple[Part, ...]:
    r, h = thing.size[0] / 2, thing.size[2]
    foot = 0.45 * r
    belly, waist = 0.80 * r, 0.45 * h
    low = foot + (belly - foot) * BASE / waist
    outer = [(low, BASE), (belly, waist), (r, h)]
    inner = [(low - WALL, BASE), (belly - WALL, waist), (r - WALL, h)]
    return (
        *painted([(0.0, 0.0), (foot, 0.0), *outer, inner[-1]], h, look),
        seen([*reversed(inner), (0.0, BASE)], look.trim),
        _touch(solid_piece([(foot, 0.0), (low, BASE)])),
        *(_touch(piece) for piece in shell_pieces(outer, inner, sectors(r))),
    )

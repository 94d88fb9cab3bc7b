"""Loose things for tables: can, bottle, box, mug, bowl. Each stands on z = 0 around its origin.

What is looked at is a lathe surface; what collides are cylinders, boxes and convex pieces of the
same shape, hollow where the thing is hollow.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from momantu_bt.geometry import Transform
from momantu_worlds.scenes.bodies import Color, Cylinder, Geometry, Part
from momantu_worlds.scenes.lathe import lathe, shell_pieces, solid_piece
from momantu_worlds.scenes.parts import block, shade

ObjectKind: TypeAlias = Literal["bottle", "box", "mug", "bowl", "can"]
OBJECT_KINDS: tuple[ObjectKind, ...] = get_args(ObjectKind)

METAL: Color = (0.72, 0.73, 0.75)
WALL = 0.005
"""m; thickness of a mug's or bowl's wall."""
BASE = 0.011
"""m; thickness of a hollow thing's bottom: a solid disc alone touches the table, so that resting
costs the physics one pair of shapes; the wall begins above the reach of contacts."""
SECTORS = 10
"""Convex pieces around a hollow thing's wall."""


@dataclass(frozen=True, slots=True)
class Thing:
    """A kind of object with its sizes.

    radius: of the circle around everything that sticks out, m; height: m; mass: kg.
    size: (3,) the box's edges, or (2 radius, 2 radius, height) of the round body alone.
    """

    kind: ObjectKind
    size: tuple[float, float, float]
    mass: float
    color: Color

    @property
    def height(self) -> float:
        """m, from the table to its top."""
        return self.size[2]

    @property
    def reach(self) -> float:
        """Radius of the upright cylinder around it, handles included, m."""
        if self.kind == "box":
            return math.hypot(self.size[0], self.size[1]) / 2
        return self.size[0] / 2 + (_handle(self.size[2]) if self.kind == "mug" else 0.0)

    def parts(self) -> tuple[Part, ...]:
        """What it is made of."""
        makers = {"can": _can, "bottle": _bottle, "box": _box, "mug": _mug, "bowl": _bowl}
        return makers[self.kind](self)


def _look(geometry: Geometry, color: Color) -> Part:
    return Part(geometry, Transform(), color, collision=False)


def _touch(geometry: Geometry, z: float = 0.0) -> Part:
    return Part(geometry, Transform((0, 0, z)), visual=False)


def _can(thing: Thing) -> tuple[Part, ...]:
    r, h = thing.size[0] / 2, thing.height
    rim, inset = 0.004, 0.94
    return (
        _look(lathe([(0.0, 0.0), (inset * r, 0.0), (r, rim), (r, 0.02 * h + rim)]), METAL),
        _look(lathe([(r, 0.02 * h + rim), (r, 0.55 * h)]), thing.color),
        _look(lathe([(r, 0.55 * h), (r, 0.70 * h)]), (0.92, 0.90, 0.84)),
        _look(lathe([(r, 0.70 * h), (r, 0.98 * h - rim)]), thing.color),
        _look(lathe([(r, 0.98 * h - rim), (r, h - rim), (inset * r, h), (0.0, h)]), METAL),
        _touch(Cylinder(r, h), h / 2),
    )


def _bottle(thing: Thing) -> tuple[Part, ...]:
    r, h = thing.size[0] / 2, thing.height
    neck, shoulder, base = 0.38 * r, 0.62 * h, 0.78 * h
    cap = shade(thing.color, 0.5)
    label = (0.90, 0.88, 0.80)
    return (
        _look(lathe([(0.0, 0.0), (r, 0.0), (r, 0.15 * h)]), thing.color),
        _look(lathe([(r, 0.15 * h), (r, 0.45 * h)]), label),
        _look(lathe([(r, 0.45 * h), (r, shoulder), (neck, base), (neck, 0.92 * h)]), thing.color),
        _look(lathe([(neck, 0.92 * h), (1.1 * neck, 0.92 * h), (1.1 * neck, h), (0.0, h)]), cap),
        _touch(Cylinder(r, shoulder), shoulder / 2),
        _touch(solid_piece([(r, shoulder), (neck, base)])),
        _touch(Cylinder(1.1 * neck, h - base), (h + base) / 2),
    )


def _box(thing: Thing) -> tuple[Part, ...]:
    x, y, z = thing.size
    return (
        block((x, y, 0.8 * z), (0, 0, 0.4 * z), thing.color),
        block((x, y, 0.2 * z), (0, 0, 0.9 * z), shade(thing.color, 0.7)),
    )


def _handle(height: float) -> float:
    return 0.35 * height


def _mug(thing: Thing) -> tuple[Part, ...]:
    r, h = thing.size[0] / 2, thing.height
    hole, floor, out = r - WALL, BASE, _handle(thing.height)
    ring = [(0.0, 0.0), (r, 0.0), (r, h), (hole, h), (hole, floor), (0.0, floor)]
    bar, low, high = 0.010, 0.25 * h, 0.80 * h
    # the bars reach into the wall, so that nothing shows between
    middle = r + (out - bar) / 2
    handle = (
        block((out, bar, bar), (middle, 0, low), thing.color),
        block((out, bar, bar), (middle, 0, high), thing.color),
        block((bar, bar, high - low + bar), (r + out - bar / 2, 0, (low + high) / 2), thing.color),
    )
    wall = shell_pieces([(r, floor), (r, h)], [(hole, floor), (hole, h)], SECTORS)
    return (
        _look(lathe(ring), thing.color),
        *handle,
        _touch(Cylinder(r, floor), floor / 2),
        *(_touch(piece) for piece in wall),
    )


def _bowl(thing: Thing) -> tuple[Part, ...]:
    r, h = thing.size[0] / 2, thing.height
    foot = 0.45 * r
    belly, waist = 0.80 * r, 0.45 * h
    low = foot + (belly - foot) * BASE / waist
    outer = [(low, BASE), (belly, waist), (r, h)]
    inner = [(low - WALL, BASE), (belly - WALL, waist), (r - WALL, h)]
    ring = [(0.0, 0.0), (foot, 0.0), *outer, *reversed(inner), (0.0, BASE)]
    return (
        _look(lathe(ring), thing.color),
        _touch(Cylinder(low, BASE), BASE / 2),
        *(_touch(piece) for piece in shell_pieces(outer, inner, SECTORS)),
    )

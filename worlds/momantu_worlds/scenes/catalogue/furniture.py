"""The furniture catalogue: the parts of each kind, from its sizes.

Every kind stands on z = 0 around its own origin and shows its front to +x. `size` is
(depth along x, width along y, height), m.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import product
from types import MappingProxyType
from typing import TypeAlias

from momantu_worlds.scenes.catalogue.shelves import BOARD, RACK, SHELF, rack, shelf
from momantu_worlds.scenes.geometry.bodies import Color, Part
from momantu_worlds.scenes.geometry.parts import Size3, block, column, shade

Maker: TypeAlias = Callable[[Size3, Color], tuple[Part, ...]]

LEG = 0.05
"""m; thickness of table legs."""
FOOT = 0.03
"""m; height of the foot of a round table."""


def table(size: Size3, color: Color) -> tuple[Part, ...]:
    """A top on four legs; its size z is the height of the top's surface."""
    depth, width, height = size
    legs = product((-1, 1), (-1, 1))
    at_x, at_y = depth / 2 - LEG, width / 2 - LEG
    under = height - BOARD
    return (
        block((depth, width, BOARD), (0, 0, height - BOARD / 2), color),
        *(
            block((LEG, LEG, under), (a * at_x, b * at_y, under / 2), shade(color, 0.7))
            for a, b in legs
        ),
    )


def round_table(size: Size3, color: Color | None = None) -> tuple[Part, ...]:
    """A disc on a column with a round foot; its colour is a table's usual one unless given."""
    diameter, _, height = size
    paint = color or CATALOGUE["table"][2]
    dark = shade(paint, 0.7)
    return (
        column(diameter / 2, height - BOARD, height, paint),
        column(LEG, FOOT, height - BOARD, dark),
        column(0.3 * diameter, 0.0, FOOT, dark),
    )


def desk(size: Size3, color: Color) -> tuple[Part, ...]:
    """A top on two side panels, with a modesty panel at the front (+x)."""
    depth, width, height = size
    under = height - BOARD
    side = (depth - 0.06, BOARD, under)
    dark = shade(color, 0.75)
    return (
        block((depth, width, BOARD), (0, 0, height - BOARD / 2), color),
        block(side, (0, width / 2 - 0.05, under / 2), dark),
        block(side, (0, 0.05 - width / 2, under / 2), dark),
        block((BOARD, width - 0.1, 0.45), (depth / 2 - 0.06, 0, under - 0.225), dark),
    )


def chair(size: Size3, color: Color) -> tuple[Part, ...]:
    """Four legs, a seat at half the height, and a back behind."""
    depth, width, height = size
    seat = 0.52 * height
    leg = 0.035
    at_x, at_y = depth / 2 - leg, width / 2 - leg
    dark = shade(color, 0.6)
    return (
        block((depth, width, 0.05), (0, 0, seat - 0.025), color),
        block((0.04, width, height - seat), (0.02 - depth / 2, 0, (height + seat) / 2), color),
        *(
            block((leg, leg, seat - 0.05), (a * at_x, b * at_y, (seat - 0.05) / 2), dark)
            for a, b in product((-1, 1), (-1, 1))
        ),
    )


def sofa(size: Size3, color: Color) -> tuple[Part, ...]:
    """Seat, back and two arms, all down to the floor."""
    depth, width, height = size
    seat, arm = 0.5 * height, 0.2
    dark = shade(color, 0.8)
    return (
        block((depth, width - 2 * arm, seat), (0, 0, seat / 2), color),
        block((0.25, width, height), (0.125 - depth / 2, 0, height / 2), dark),
        block((depth, arm, 0.72 * height), (0, (width - arm) / 2, 0.36 * height), dark),
        block((depth, arm, 0.72 * height), (0, (arm - width) / 2, 0.36 * height), dark),
    )


def crate(size: Size3, color: Color) -> tuple[Part, ...]:
    """A closed box on the floor, with a lid of another shade."""
    depth, width, height = size
    lid = 0.03
    return (
        block((depth, width, height - lid), (0, 0, (height - lid) / 2), color),
        block((depth, width, lid), (0, 0, height - lid / 2), shade(color, 1.2)),
    )


def cabinet(size: Size3, color: Color) -> tuple[Part, ...]:
    """A closed chest with two doors to the front."""
    depth, width, height = size
    door = (0.02, width / 2 - 0.02, height - 0.1)
    body = depth - 0.02
    return (
        block((body, width, height), (-0.01, 0, height / 2), color),
        block(door, (depth / 2 - 0.01, width / 4, height / 2), shade(color, 1.15)),
        block(door, (depth / 2 - 0.01, -width / 4, height / 2), shade(color, 1.15)),
    )


def counter(size: Size3, color: Color) -> tuple[Part, ...]:
    """A kitchen's worktop on closed cupboards, set back at the floor for the toes."""
    depth, width, height = size
    toe, top = 0.10, 0.04
    body = depth - 0.04
    front = (0.016, width / 2 - 0.01, height - top - toe - 0.02)
    middle = (height - top + toe) / 2
    return (
        block((depth, width, top), (0, 0, height - top / 2), shade(color, 0.6)),
        block((body, width, height - top - toe), (-0.02, 0, middle), color),
        block(front, (depth / 2 - 0.032, width / 4, middle), shade(color, 1.1)),
        block(front, (depth / 2 - 0.032, -width / 4, middle), shade(color, 1.1)),
        block((body - 0.06, width, toe), (-0.05, 0, toe / 2), shade(color, 0.5)),
    )


def bed(size: Size3, color: Color) -> tuple[Part, ...]:
    """A mattress in a frame down to the floor, with a headboard behind."""
    depth, width, height = size
    frame, mattress = 0.28, 0.20
    sheet: Color = (0.86, 0.86, 0.88)
    length = depth - BOARD
    return (
        block((length, width, frame), (BOARD / 2, 0, frame / 2), color),
        block((length, width - 0.04, mattress), (BOARD / 2, 0, frame + mattress / 2), sheet),
        block((BOARD, width, height), ((BOARD - depth) / 2, 0, height / 2), color),
    )


def pallet(size: Size3, color: Color) -> tuple[Part, ...]:
    """Three runners with boards across."""
    depth, width, height = size
    deck = 0.25 * height
    dark = shade(color, 0.8)
    return (
        block((depth, width, deck), (0, 0, height - deck / 2), color),
        *(
            block(
                (depth, 0.1, height - deck), (0, y * (width / 2 - 0.05), (height - deck) / 2), dark
            )
            for y in (-1, 0, 1)
        ),
    )


def plant(size: Size3, color: Color) -> tuple[Part, ...]:
    """A pot with a stem and a round of leaves above; the leaves are as wide as the size says."""
    depth, _, height = size
    pot = 0.35 * height
    return (
        column(0.32 * depth, 0.0, pot, (0.55, 0.33, 0.24)),
        column(0.03, pot, 0.6 * height, (0.35, 0.25, 0.15)),
        column(depth / 2, 0.6 * height, height, color),
    )


def figure(size: Size3, color: Color) -> tuple[Part, ...]:
    """A standing person: legs, trunk, arms, head."""
    depth, width, height = size
    hip, neck = 0.48 * height, 0.84 * height
    leg = 0.2 * width
    skin: Color = (0.85, 0.66, 0.54)
    trousers = shade(color, 0.45)
    return (
        column(leg, 0.0, hip, trousers, y=0.27 * width),
        column(leg, 0.0, hip, trousers, y=-0.27 * width),
        block((depth, 0.72 * width, neck - hip), (0, 0, (neck + hip) / 2), color),
        block((0.4 * depth, 0.13 * width, 0.36 * height), (0, 0.43 * width, 0.65 * height), color),
        block((0.4 * depth, 0.13 * width, 0.36 * height), (0, -0.43 * width, 0.65 * height), color),
        column(0.055 * height, neck, height, skin),
    )


CATALOGUE: Mapping[str, tuple[Maker, Size3, Color]] = MappingProxyType(
    {
        "table": (table, (0.8, 1.4, 0.72), (0.72, 0.56, 0.38)),
        "desk": (desk, (0.8, 1.5, 0.72), (0.66, 0.50, 0.34)),
        "chair": (chair, (0.45, 0.45, 0.90), (0.30, 0.36, 0.44)),
        "sofa": (sofa, (0.85, 1.90, 0.80), (0.42, 0.47, 0.50)),
        "shelf": (shelf, (0.35, 1.60, 1.90), SHELF),
        "rack": (rack, (0.60, 2.40, 1.80), RACK),
        "crate": (crate, (0.45, 0.55, 0.50), (0.70, 0.55, 0.36)),
        "cabinet": (cabinet, (0.45, 1.20, 0.90), (0.55, 0.56, 0.58)),
        "counter": (counter, (0.60, 1.80, 0.88), (0.80, 0.79, 0.76)),
        "bed": (bed, (2.00, 1.40, 0.90), (0.52, 0.38, 0.26)),
        "pallet": (pallet, (0.80, 1.20, 0.15), (0.74, 0.60, 0.42)),
        "plant": (plant, (0.50, 0.50, 1.30), (0.22, 0.45, 0.22)),
        "figure": (figure, (0.24, 0.50, 1.75), (0.35, 0.42, 0.62)),
    }
)
"""Kind -> how to make it, its usual size and its usual colour."""


def furniture(kind: str, size: Size3 | None = None, color: Color | None = None) -> tuple[Part, ...]:
    """The parts of one piece; size and colour are the usual ones unless given."""
    make, usual_size, usual_color = CATALOGUE[kind]
    return make(size or usual_size, color or usual_color)


def usual_size(kind: str) -> Size3:
    """(depth, width, height) of a kind, m."""
    return CATALOGUE[kind][1]

"""Shelves and racks: frames with boards, at usual heights or those of a world file.

`size` is (depth along x, width along y, height), m; the front is +x.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from itertools import product
from types import MappingProxyType

from momantu_worlds.scenes.geometry.bodies import Color, Part
from momantu_worlds.scenes.geometry.parts import Size3, block, shade

BOARD = 0.03
"""m; thickness of boards and panels."""
POST = 0.05
"""m; thickness of a rack's posts."""
SHELF: Color = (0.62, 0.52, 0.42)
RACK: Color = (0.20, 0.34, 0.56)
"""Colour of a rack's posts."""
_DECK: Color = (0.73, 0.64, 0.50)
"""Colour of a rack's boards: chipboard."""


def shelf(size: Size3, color: Color) -> tuple[Part, ...]:
    """Sides, a back and boards about every 0.38 m, open to the front."""
    height = size[2]
    boards = max(2, round(height / 0.38) + 1)
    gap = (height - BOARD) / (boards - 1)
    middles = (BOARD / 2 + i * gap for i in range(boards))
    return (*_shelf_frame(size, color), *(_shelf_board(size, m, color) for m in middles))


def rack(size: Size3, color: Color) -> tuple[Part, ...]:
    """Four posts with boards about every 0.5 m, open to the front and to the back."""
    height = size[2]
    boards = max(2, round(height / 0.5))
    middles = (BOARD / 2 + 0.1 + i * (height - 0.1 - BOARD) / (boards - 1) for i in range(boards))
    return (*_rack_frame(size, color), *(_rack_board(size, m, color) for m in middles))


def _shelf_frame(size: Size3, color: Color) -> tuple[Part, ...]:
    depth, width, height = size
    inner = width - 2 * BOARD
    return (
        block((depth, BOARD, height), (0, (width - BOARD) / 2, height / 2), color),
        block((depth, BOARD, height), (0, (BOARD - width) / 2, height / 2), color),
        block((0.01, inner, height), (0.005 - depth / 2, 0, height / 2), shade(color, 0.8)),
    )


def _shelf_board(size: Size3, middle: float, color: Color) -> Part:
    depth, width, _ = size
    return block((depth - 0.01, width - 2 * BOARD, BOARD), (0.005, 0, middle), color)


def _rack_frame(size: Size3, color: Color) -> tuple[Part, ...]:
    depth, width, height = size
    at_x, at_y = (depth - POST) / 2, (width - POST) / 2
    return tuple(
        block((POST, POST, height), (a * at_x, b * at_y, height / 2), color)
        for a, b in product((-1, 1), (-1, 1))
    )


def _rack_board(size: Size3, middle: float, color: Color) -> Part:
    """A board between the posts at its ends."""
    depth, width, _ = size
    return block((depth, width - 2 * POST, BOARD), (0, 0, middle), _DECK)


BOARDED: Mapping[
    str,
    tuple[Callable[[Size3, Color], tuple[Part, ...]], Callable[[Size3, float, Color], Part], Color],
] = MappingProxyType(
    {
        "shelf": (_shelf_frame, _shelf_board, SHELF),
        "rack": (_rack_frame, _rack_board, RACK),
    }
)
"""Kinds whose boards a world file may place: how to make the frame, one board, the usual colour."""


def boarded(kind: str, size: Size3, color: Color | None, tops: Iterable[float]) -> tuple[Part, ...]:
    """A shelf or rack with boards whose tops are at these heights, m."""
    frame, _, usual = BOARDED[kind]
    own = color or usual
    return (*frame(size, own), *(board(kind, size, top, color) for top in tops))


def board(kind: str, size: Size3, top: float, color: Color | None) -> Part:
    """One board of a shelf or rack, its top at a height, m."""
    _, make, usual = BOARDED[kind]
    return make(size, top - BOARD / 2, color or usual)

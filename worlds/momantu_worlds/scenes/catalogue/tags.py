"""Pictures of AprilTags (Olson 2011; Wang and Olson 2016; Krogius et al. 2019)."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from momantu_bt.tags import FAMILIES, USUAL_FAMILY, TagFamily

_TABLE = Path(__file__).with_name("tag_families.json")
"""Written by `setup/tag_families.py`."""
WHITE, BLACK = 235, 20
"""Grey levels of the print."""
MOST_IDS = 587
"""The table has so many ids of a family, or all."""
CELL = 32
"""Pixels along a cell of a picture."""


@dataclass(frozen=True, slots=True)
class _Family:
    """border: cells along the edge. cells: along the whole picture, border and surroundings.

    reversed: white within the border, black around it. columns, rows: of each bit, from the
    border's upper left corner; the first bit is the highest of a code. codes: of the known ids.
    """

    border: int
    cells: int
    reversed: bool
    columns: tuple[int, ...]
    rows: tuple[int, ...]
    codes: tuple[int, ...]


@cache
def _families() -> Mapping[str, _Family]:
    table = json.loads(_TABLE.read_text(encoding="utf-8"))
    return MappingProxyType(
        {
            name: _Family(
                each["border"],
                each["cells"],
                each["reversed"],
                tuple(each["columns"]),
                tuple(each["rows"]),
                tuple(int(code, 16) for code in each["codes"].split()),
            )
            for name, each in table.items()
        }
    )


def known_ids(family: TagFamily = USUAL_FAMILY) -> int:
    """How many ids of a family can be printed: those from 0 on."""
    return len(_families()[family].codes)


def tag_cells(tag_id: int, family: TagFamily = USUAL_FAMILY) -> NDArray[np.bool_]:
    """The tag upright as (n, n) cells, True where white, row 0 at the top.

    Raises:
        ValueError: no code of that id is known here.
    """
    found = _families()[family]
    if not 0 <= tag_id < len(found.codes):
        raise ValueError(f"{family} id {tag_id} is not known; known: 0 to {len(found.codes) - 1}")
    cells = np.zeros((found.cells, found.cells), dtype=np.bool_)
    start = (found.cells - found.border) // 2
    ring = start if found.reversed else start - 1
    within = slice(ring, found.cells - ring)
    cells[within, within] = True
    inner = slice(ring + 1, found.cells - ring - 1)
    cells[inner, inner] = False
    code, count = found.codes[tag_id], len(found.columns)
    for bit, (column, row) in enumerate(zip(found.columns, found.rows, strict=True)):
        cells[start + row, start + column] = bool(code >> (count - 1 - bit) & 1)
    return cells


def tag_picture(tag_id: int, family: TagFamily = USUAL_FAMILY) -> NDArray[np.uint8]:
    """The tag as an RGB picture of `CELL` pixels a cell, with what belongs around it."""
    grey = np.where(tag_cells(tag_id, family), WHITE, BLACK).astype(np.uint8)
    picture = np.kron(grey, np.ones((CELL, CELL), dtype=np.uint8))
    return np.ascontiguousarray(np.repeat(picture[:, :, None], 3, axis=2))


def shown_by(pixels: NDArray[np.uint8]) -> tuple[TagFamily, int] | None:
    """Family and id of the tag that a picture of `tag_picture` shows; None for other pictures."""
    if pixels.shape[0] % CELL or pixels.shape[0] != pixels.shape[1]:
        return None
    cells = pixels[CELL // 2 :: CELL, CELL // 2 :: CELL, 0] > (WHITE + BLACK) // 2
    return _known().get(cells.tobytes())


def cells_along(pixels: NDArray[np.uint8]) -> int:
    """How many cells a tag's picture has along its edge; of other pictures the usual family's."""
    shown = shown_by(pixels)
    return _families()[USUAL_FAMILY if shown is None else shown[0]].cells


@cache
def _known() -> Mapping[bytes, tuple[TagFamily, int]]:
    return MappingProxyType(
        {
            tag_cells(tag_id, family).tobytes(): (family, tag_id)
            for family in FAMILIES
            for tag_id in range(known_ids(family))
        }
    )


def cell_of(edge: float, family: TagFamily = USUAL_FAMILY) -> float:
    """Edge of a cell, m, of a tag whose edge is `edge` m."""
    return edge / _families()[family].border


def picture_edge(edge: float, family: TagFamily = USUAL_FAMILY) -> float:
    """Extent of the whole picture, m, of a tag whose edge is `edge` m."""
    return cell_of(edge, family) * _families()[family].cells

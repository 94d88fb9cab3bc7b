"""Pictures of AprilTags of the family 36h11 (Olson 2011; Wang and Olson 2016)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

CODES = (
    0xD5D628584,
    0xD97F18B49,
    0xDD280910E,
    0xE479E9C98,
    0xEBCBCA822,
    0xF31DAB3AC,
    0x56A5D085,
    0x10652E1D4,
    0x22B1DFEAD,
    0x265AD0472,
    0x34FE91B86,
    0x3FF962CD5,
    0x43A25329A,
    0x474B4385F,
    0x4E9D243E9,
    0x5246149AE,
    0x5997F5538,
    0x683BB6C4C,
    0x6BE4A7211,
    0x7E3158EEA,
    0x81DA494AF,
    0x858339A74,
    0x8CD51A5FE,
    0x9F21CC2D7,
    0xA2CABC89C,
    0xADC58D9EB,
    0xB16E7DFB0,
    0xB8C05EB3A,
    0xD25EF139D,
    0xD607E1962,
)
"""The first thirty of the family's 587 codes: 36 bits, row by row from the top left, 1 is white."""

DATA = 6
"""Cells along an edge that carry bits; one black cell and one white cell lie around them."""
BLACK = DATA + 2
CELLS = DATA + 4


def tag_cells(tag_id: int) -> NDArray[np.bool_]:
    """The tag upright as (10, 10) cells, True where white, row 0 at the top.

    Raises:
        ValueError: no code of that id is known here.
    """
    if not 0 <= tag_id < len(CODES):
        raise ValueError(f"tag id {tag_id} is not known; known: 0 to {len(CODES) - 1}")
    bits = [(CODES[tag_id] >> (DATA * DATA - 1 - i)) & 1 for i in range(DATA * DATA)]
    cells = np.ones((CELLS, CELLS), dtype=np.bool_)
    cells[1:-1, 1:-1] = False
    cells[2:-2, 2:-2] = np.array(bits, dtype=np.bool_).reshape(DATA, DATA)
    return cells


def tag_picture(tag_id: int, cell: int = 32) -> NDArray[np.uint8]:
    """The tag as an RGB picture of `cell` pixels a cell, white margin included."""
    cells = tag_cells(tag_id)
    grey = np.where(cells, 235, 20).astype(np.uint8)
    picture = np.kron(grey, np.ones((cell, cell), dtype=np.uint8))
    return np.ascontiguousarray(np.repeat(picture[:, :, None], 3, axis=2))


def picture_edge(black_edge: float) -> float:
    """Extent of the whole picture, m, when the black square's edge is `black_edge` m long."""
    return black_edge * CELLS / BLACK

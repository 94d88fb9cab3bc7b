"""The recorded floor plan as a picture that suits a light and a dark page."""

from __future__ import annotations

import base64
import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from momantu_bt.lazy import lazily
from momantu_bt.record.channels.floor_plan import FREE_BYTE, OCCUPIED_BYTE
from momantu_bt.record.recording import Recording

with lazily():
    from PIL import Image


_COLOURS = {"free": (0, 0, 0, 0), "occupied": (112, 118, 126, 255), "unknown": (128, 128, 128, 40)}
"""Red, green, blue, opacity."""


def plan_image(recording: Recording) -> dict[str, Any] | None:
    """The picture and its position, m; None if no floor plan was recorded.

    x, y: its lower left corner. used: left, bottom, right, top of its known part.
    """
    if "/map" not in recording.topics():
        return None
    _, grid = next(iter(recording.messages("/map")))
    cells = np.frombuffer(base64.b64decode(grid["data"]), dtype=np.uint8)
    cells = cells.reshape(-1, grid["row_stride"])[:, : grid["column_count"]]
    corner, size = grid["pose"]["position"], grid["cell_size"]
    rows, columns = cells.shape
    known_rows, known_columns = np.nonzero((cells == FREE_BYTE) | (cells == OCCUPIED_BYTE))
    if len(known_rows) == 0:
        known_rows, known_columns = np.array([0, rows - 1]), np.array([0, columns - 1])
    return {
        "data": f"data:image/png;base64,{base64.b64encode(_png(cells)).decode('ascii')}",
        "x": corner["x"],
        "y": corner["y"],
        "width": columns * size["x"],
        "height": rows * size["y"],
        "used": [
            corner["x"] + float(known_columns.min()) * size["x"],
            corner["y"] + float(known_rows.min()) * size["y"],
            corner["x"] + float(known_columns.max() + 1) * size["x"],
            corner["y"] + float(known_rows.max() + 1) * size["y"],
        ],
    }


def _png(cells: NDArray[np.uint8]) -> bytes:
    """Three colours, the first row at the bottom."""
    kinds = np.full(cells.shape, 2, dtype=np.uint8)
    kinds[cells == FREE_BYTE] = 0
    kinds[cells == OCCUPIED_BYTE] = 1
    picture = Image.fromarray(kinds[::-1].copy(), mode="P")
    picture.putpalette([part for colour in _COLOURS.values() for part in colour[:3]])
    out = io.BytesIO()
    picture.save(out, "PNG", transparency=bytes(c[3] for c in _COLOURS.values()), optimize=True)
    return out.getvalue()

"""How much of the picture the boards cover, and a plot of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_bt.lazy import lazily
from momantu_skills.calibration.camera.lens import Lens
from momantu_skills.calibration.camera.pictures import Pictures

with lazily():
    import cv2

CELLS = 5
"""The picture is divided into this many columns, and as many rows."""
_LONGER = 50.0
"""Residuals are drawn this many times as long as they are."""


def covered(pictures: Pictures, lens: Lens) -> NDArray[np.intp]:
    """How many points of pictures that count lie in each cell (CELLS, CELLS), row by row."""
    cells = np.zeros((CELLS, CELLS), dtype=np.intp)
    for each, used in zip(pictures.seen, lens.used, strict=True):
        if used:
            column, row = (each.pixels / pictures.size * CELLS).clip(0, CELLS - 1).astype(int).T
            np.add.at(cells, (row, column), 1)
    return cells


def gain(pictures: Pictures, lens: Lens) -> Array:
    """What share of the covered cells only this picture covers, for each picture (N,)."""
    cells = [
        {tuple(cell) for cell in (each.pixels / pictures.size * CELLS).astype(int)}
        for each in pictures.seen
    ]
    shares = []
    for index, own in enumerate(cells):
        others = set().union(*(c for i, c in enumerate(cells) if i != index and lens.used[i]))
        shares.append(len(own - others) / max(1, len(own | others)))
    return np.array(shares)


def plot(pictures: Pictures, lens: Lens) -> bytes:
    """A PNG: all points that were found, the residuals 50 times as long, wrong pictures in red."""
    width, height = pictures.size
    canvas = np.full((height, width, 3), 255, dtype=np.uint8)
    for line in range(1, CELLS):
        x, y = width * line // CELLS, height * line // CELLS
        cv2.line(canvas, (x, 0), (x, height), (225, 225, 225))
        cv2.line(canvas, (0, y), (width, y), (225, 225, 225))
    radius = max(1, width // 400)
    for each, off, used in zip(pictures.seen, lens.residuals, lens.used, strict=True):
        color = (180, 110, 20) if used else (40, 40, 220)
        for pixel, residual in zip(each.pixels, off, strict=True):
            begin = tuple(int(v) for v in pixel.round())
            end = tuple(int(v) for v in (pixel + _LONGER * residual).round())
            cv2.line(canvas, begin, end, color, 1, cv2.LINE_AA)
            cv2.circle(canvas, begin, radius, color, -1, cv2.LINE_AA)
    return bytes(cv2.imencode(".png", canvas)[1])

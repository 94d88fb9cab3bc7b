"""A map as text: walls as blocks, free floor as dots, and on it the way, the robot and names."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from rich.text import Text

from momantu_bt.formats.maps import FREE, OCCUPIED
from momantu_bt.geometry import Pose2D
from momantu_skills.mapping.pictures.raster import known_part, resampled
from momantu_skills.navigation.map.maps import GridMap

BOTH, UPPER, LOWER, FLOOR, NOTHING = "█▀▄· "
WAY, ROBOT = "•", "@"
MARKS = "123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ"
"""The marks of names, one after the other; names beyond them are listed without a mark."""
_STYLE = {FLOOR: "dim", WAY: "red", ROBOT: "bold green"}
_MARK = "bold cyan"
LARGEST = 4
"""Most pixels of a cell's edge: a small map is not blown up."""


@dataclass(frozen=True, slots=True)
class Overlay:
    """What lies on a map. way: poses driven. robot: where it is now. places: by their names."""

    way: Sequence[Pose2D] = ()
    robot: Pose2D | None = None
    places: Mapping[str, Pose2D] = field(default_factory=dict)


def map_text(grid: GridMap, columns: int, rows: int | None, overlay: Overlay) -> Text:
    """The known part of a map, as large as it fits into columns and rows of text.

    rows: None: as many as it takes. A column stands for as much floor as half a row.
    """
    part = known_part(grid)
    high, wide = part.cells.shape
    scale = min(columns / wide, LARGEST)
    if rows is not None:
        scale = min(scale, 2 * rows / high)
    across = max(1, min(columns, int(wide * scale)))
    down = max(1, int(high * scale / 2))
    signs = _signs(resampled(part.cells, 2 * down, across))
    canvas = _Canvas(signs, part)
    for pose in overlay.way:
        canvas.put(pose, WAY)
    for mark, pose in zip(MARKS, overlay.places.values(), strict=False):
        canvas.put(pose, mark)
    if overlay.robot is not None:
        canvas.put(overlay.robot, ROBOT)
    return canvas.text()


def _signs(pixels: NDArray[np.uint8]) -> NDArray[np.str_]:
    """Signs (rows, columns), the uppermost first, of pixels (2 rows, columns) from below."""
    upright = pixels[::-1]
    above, below = upright[0::2] == OCCUPIED, upright[1::2] == OCCUPIED
    free = (upright[0::2] == FREE) | (upright[1::2] == FREE)
    return np.where(
        above & below,
        BOTH,
        np.where(above, UPPER, np.where(below, LOWER, np.where(free, FLOOR, NOTHING))),
    )


class _Canvas:
    """Signs of a map, onto which others are put."""

    def __init__(self, signs: NDArray[np.str_], part: GridMap) -> None:
        self._signs, self._part = signs, part

    def put(self, pose: Pose2D, sign: str) -> None:
        """Put a sign where a pose lies; beside the map nothing is put."""
        rows, columns = self._signs.shape
        (x, y), (width, height) = self._part.origin, self._part.size
        column = int(np.floor((pose.x - x) / width * columns))
        row = rows - 1 - int(np.floor((pose.y - y) / height * rows))
        if 0 <= row < rows and 0 <= column < columns:
            self._signs[row, column] = sign

    def text(self) -> Text:
        """All lines, with their colours."""
        text = Text(no_wrap=True, overflow="crop", end="")
        for number, line in enumerate(self._signs):
            if number:
                text.append("\n")
            starts = [0, *(np.flatnonzero(line[1:] != line[:-1]) + 1), len(line)]
            for first, last in itertools.pairwise(starts):
                sign = str(line[first])
                style = _MARK if sign in MARKS else _STYLE.get(sign, "")
                text.append(sign * int(last - first), style)
        return text

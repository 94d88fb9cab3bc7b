"""One picture of a film: the scene, what the head camera sees, and the tree's state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import Any, TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from momantu_bt.folding import fitted
from momantu_bt.world import TreeLine

Image: TypeAlias = NDArray[np.uint8]

WIDTH, HEIGHT = 1280, 720
SCENE = (800, 720)
"""(width, height), px, of the third-person view; the rest of the width is the side panel."""
PANEL = WIDTH - SCENE[0]
HEAD = (PANEL, PANEL * 3 // 4)
"""(width, height), px, of the head camera's picture."""
MARGIN = 10
TEXT = 12
"""Height of the tree's letters, px."""
LINE = 17
"""Distance between lines of the tree, px."""
BACKGROUND = (24, 26, 30)
COLORS: Mapping[str, tuple[int, int, int]] = MappingProxyType(
    {
        "RUNNING": (255, 205, 90),
        "SUCCESS": (130, 210, 130),
        "FAILURE": (240, 110, 100),
        "SKIPPED": (120, 130, 150),
    }
)
"""RGB of a status; any other status is grey."""
GREY = (150, 152, 156)
WHITE = (238, 238, 238)


def compose(scene: Image, head: Image, lines: Sequence[TreeLine], headline: str) -> Image:
    """The whole picture (720, 1280, 3) uint8 RGB from two RGB pictures of any size."""
    picture = np.empty((HEIGHT, WIDTH, 3), dtype=np.uint8)
    picture[:] = BACKGROUND
    picture[:, : SCENE[0]] = _fit(scene, SCENE)
    picture[: HEAD[1], SCENE[0] :] = _fit(head, HEAD)
    left, top = SCENE[0] + MARGIN, HEAD[1] + 26
    _write(picture, headline, (left, top), 15, WHITE)
    _tree(picture, lines, left, top + 14)
    return picture


def _tree(picture: Image, lines: Sequence[TreeLine], left: int, top: int) -> None:
    room = (HEIGHT - top) // LINE
    for row, line in enumerate(fitted(lines, room)):
        color = COLORS.get(line.status, GREY)
        at = (left + 12 * line.depth, top + LINE * (row + 1) - 4)
        _write(picture, line.text, at, TEXT, color)


def _fit(image: Image, size: tuple[int, int]) -> Image:
    """The picture scaled to cover (width, height), its middle kept."""
    rows, columns = image.shape[:2]
    scale = max(size[0] / columns, size[1] / rows)
    wide, high = round(columns * scale), round(rows * scale)
    if (wide, high) != (columns, rows):
        image = np.asarray(cv2.resize(image, (wide, high), interpolation=cv2.INTER_AREA))
    x, y = (wide - size[0]) // 2, (high - size[1]) // 2
    return image[y : y + size[1], x : x + size[0]]


def _write(
    picture: Image, text: str, at: tuple[int, int], size: int, color: tuple[int, int, int]
) -> None:
    """Text with its baseline's left end at `at`; what does not fit is cut off."""
    cv2.putText(picture, text, at, color, _font(), size, 400)


@cache
def _font() -> Any:
    return cv2.FontFace("sans")

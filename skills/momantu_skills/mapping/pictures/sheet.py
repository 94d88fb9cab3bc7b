"""A picture of a raster of the floor, with a scale bar, a key, lines, marks and words on it."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Pose2D
from momantu_bt.lazy import lazily

with lazily():
    from PIL import Image, ImageDraw, ImageFont

Rgb = tuple[int, int, int]
INK: Rgb = (30, 30, 30)
PAPER: Rgb = (255, 255, 255)
SHORTEST, LONGEST = 900, 2400
"""Pixels of the floor's longer side: small maps are drawn larger, large ones smaller."""
NARROWEST = 640
"""Least width of the picture, px: room for the key."""
EDGE, LINE = 14, 24
"""Pixels around what is written, and the height of a line."""
FONT = 16
_BARS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0)
_BAR_SHARE = 0.25
"""Largest length of the scale bar as a share of the picture's width."""


def pixels_of(shape: tuple[int, int]) -> tuple[int, int]:
    """Pixels (rows, columns) of the floor on a picture of a raster (rows, columns)."""
    longer = max(shape)
    scale = 1.0
    if longer < SHORTEST:
        scale = math.ceil(SHORTEST / longer)
    elif longer > LONGEST:
        scale = LONGEST / longer
    return max(1, round(shape[0] * scale)), max(1, round(shape[1] * scale))


class Sheet:
    """A picture of the floor, and beneath it the scale bar and the key."""

    def __init__(
        self,
        colors: NDArray[np.uint8],
        extent: tuple[float, float],
        origin: tuple[float, float],
        key: Sequence[tuple[Rgb, str]] = (),
        notes: Sequence[str] = (),
    ) -> None:
        """Lay out the picture.

        colors: (rows, columns, 3), row 0 at the least y. extent: x and y of the floor, m. origin:
        (x, y) of its lower left corner, m. key: colours and what they mean. notes: lines of text.
        """
        rows, columns = colors.shape[:2]
        self._scale: tuple[float, float] = (columns / extent[0], rows / extent[1])
        self._origin, self._rows = origin, rows
        width = max(columns, NARROWEST)
        self._left = (width - columns) // 2
        lines = _rows_of(key, width - 2 * EDGE)
        height = rows + 2 * EDGE + LINE * (1 + len(lines) + len(notes)) + LINE // 2
        self._image = Image.new("RGB", (width, height), PAPER)
        self._image.paste(Image.fromarray(np.ascontiguousarray(colors[::-1])), (self._left, 0))
        self._draw = ImageDraw.Draw(self._image, "RGBA")
        self._bar(rows + EDGE, extent[0])
        top = rows + EDGE + LINE + LINE // 2
        for line in lines:
            self._key_line(line, top)
            top += LINE
        for note in notes:
            self._draw.text((EDGE, top), note, INK, _font(FONT))
            top += LINE

    @property
    def per_metre(self) -> float:
        """Pixels per metre."""
        return self._scale[0]

    def line(self, points: Array, color: Rgb, width: float = 2.0) -> None:
        """Connected points (n, 2), map, m; width in px."""
        if len(points) > 1:
            joined = [self._at(x, y) for x, y in points]
            self._draw.line(joined, color, max(1, round(width)), joint="curve")

    def dot(self, x: float, y: float, color: Rgb, radius: float = 6.0) -> None:
        """A disc with a rim at a point of the map; radius in px."""
        u, v = self._at(x, y)
        around = (u - radius, v - radius, u + radius, v + radius)
        self._draw.ellipse(around, fill=color, outline=PAPER)

    def arrow(self, pose: Pose2D, color: Rgb, length: float = 16.0) -> None:
        """A disc at a pose of the map, with a line to where it faces; length in px."""
        self.dot(pose.x, pose.y, color, length / 3)
        u, v = self._at(pose.x, pose.y)
        ahead = u + length * math.cos(pose.yaw), v - length * math.sin(pose.yaw)
        self._draw.line([(u, v), ahead], color, 3)

    def outline(self, corners: Array, color: Rgb) -> None:
        """A filled polygon (n, 2) through which the floor is seen."""
        joined = [self._at(x, y) for x, y in corners]
        self._draw.polygon(joined, fill=(*color, 70))
        self._draw.line([*joined, joined[0]], color, 2)

    def word(self, text: str, x: float, y: float, color: Rgb = INK) -> None:
        """A word with a halo above a point of the map, inside the picture."""
        font = _font(FONT)
        left, top, right, bottom = font.getbbox(text)
        u, v = self._at(x, y)
        u = min(max(u - (right - left) / 2, 4), self._image.width - (right - left) - 4)
        v = max(v - (bottom - top) - 14, 4)
        self._draw.text((u, v), text, color, font, stroke_width=3, stroke_fill=PAPER)

    def png(self) -> bytes:
        """The file's content."""
        stream = io.BytesIO()
        self._image.save(stream, "PNG")
        return stream.getvalue()

    def _at(self, x: float, y: float) -> tuple[float, float]:
        across, up = self._scale
        return (
            self._left + (x - self._origin[0]) * across,
            self._rows - (y - self._origin[1]) * up,
        )

    def _bar(self, top: int, width: float) -> None:
        room = _BAR_SHARE * max(width, NARROWEST / self.per_metre)
        metres = max((each for each in _BARS if each <= room), default=_BARS[0])
        pixels, y = metres * self.per_metre, top + LINE - 8
        self._draw.line([(EDGE, y), (EDGE + pixels, y)], INK, 3)
        for x in (EDGE, EDGE + pixels):
            self._draw.line([(x, y - 6), (x, y + 6)], INK, 3)
        said = f"{metres:g} m"
        self._draw.text((EDGE + pixels + 12, y - FONT / 2 - 3), said, INK, _font(FONT))

    def _key_line(self, line: Sequence[tuple[int, Rgb, str]], top: int) -> None:
        for x, color, text in line:
            box = (EDGE + x, top + 3, EDGE + x + FONT, top + 3 + FONT)
            self._draw.rectangle(box, fill=color, outline=INK)
            self._draw.text((EDGE + x + FONT + 8, top), text, INK, _font(FONT))


def _rows_of(key: Sequence[tuple[Rgb, str]], width: int) -> list[list[tuple[int, Rgb, str]]]:
    """The entries of a key on lines, each with its distance from the left, px."""
    lines: list[list[tuple[int, Rgb, str]]] = []
    x = width
    for color, text in key:
        wide = FONT + 8 + round(_font(FONT).getlength(text)) + 24
        if x + wide > width:
            lines.append([])
            x = 0
        lines[-1].append((x, color, text))
        x += wide
    return lines


@cache
def _font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """The font that Pillow brings: the same on every machine."""
    return ImageFont.load_default(size)

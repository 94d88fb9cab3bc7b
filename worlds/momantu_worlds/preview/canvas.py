"""Drawing polygons, lines and words on a picture, in metres of the map."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from momantu_bt.geometry import Array

SMOOTH = 2
"""Supersampling factor, for smooth edges."""
MOST_PIXELS = 2200
"""px; the longer side of a picture."""

SMALL_SCALE, LARGEST = 70.0, 1.5
"""px per metre above which text grows with the picture, and its largest factor."""

Rgb = tuple[int, int, int]
Rgba = tuple[int, int, int, int]
Point = Sequence[float] | Array

WHITE: Rgb = (255, 255, 255)


class Canvas:
    """A picture of a rectangle of the floor; x to the right, y up."""

    def __init__(self, low: Array, high: Array, width: int, color: Rgb) -> None:
        """low, high: the rectangle's corners (2,), m. width: of the finished picture, px."""
        extent = high - low
        scale = min(width / extent[0], MOST_PIXELS / extent.max())
        self.scale = float(scale)
        """px of the finished picture per metre."""
        self._low, self._high = low, high
        self.size = (round(float(extent[0]) * scale), round(float(extent[1]) * scale))
        """(width, height) of the finished picture, px."""
        self._image = Image.new("RGB", (self.size[0] * SMOOTH, self.size[1] * SMOOTH), color)
        self._draw = ImageDraw.Draw(self._image, "RGBA")
        self._written: list[tuple[float, float, float, float]] = []

    def picture(self) -> Image.Image:
        """What was drawn."""
        return self._image.resize(self.size, Image.Resampling.LANCZOS)

    def mask(self, cover: Image.Image, color: Rgb, corner: Point, extent: Point) -> None:
        """Colour what a grey picture covers, its row 0 at the least y.

        corner: of its least x and y; extent: of the whole picture, m.
        """
        size = [max(1, round(float(length) * self.scale * SMOOTH)) for length in extent]
        upright = cover.transpose(Image.Transpose.FLIP_TOP_BOTTOM)
        left, bottom = self._at(corner)
        at = (round(left), round(bottom) - size[1])
        smooth = upright.resize((size[0], size[1]), Image.Resampling.BILINEAR)
        self._image.paste(Image.new("RGB", (size[0], size[1]), color), at, smooth)

    def polygon(
        self, points: Array, fill: Rgb | Rgba | None, line: Rgb | None, width: float = 1
    ) -> None:
        """A closed outline (n, 2); width in px."""
        corners = [self._at(point) for point in points]
        if fill is not None:
            self._draw.polygon(corners, fill=fill)
        if line is not None:
            self._draw.line([*corners, *corners[:2]], line, round(width * SMOOTH), joint="curve")

    def line(self, points: Array, color: Rgb, width: float = 1) -> None:
        """Connected points (n, 2); width in px."""
        joined = [self._at(point) for point in points]
        self._draw.line(joined, color, round(width * SMOOTH), joint="curve")

    def dot(self, point: Point, pixels: float, color: Rgb) -> None:
        """A disc of a radius in px."""
        x, y = self._at(point)
        r = pixels * SMOOTH
        self._draw.ellipse((x - r, y - r, x + r, y + r), fill=color)

    def text(
        self,
        content: str,
        near: Point,
        color: Rgb,
        size: int = 13,
        *,
        above: float = 0.0,
        always: bool = True,
    ) -> None:
        """Text around a point with a halo, moved up or down to where there is no text yet.

        above: px by which they are moved up. always: else they are left out where there is no room.
        """
        larger = float(np.clip(self.scale / SMALL_SCALE, 1.0, LARGEST))
        font = _font(round(size * larger) * SMOOTH)
        left, top, right, bottom = font.getbbox(content)
        wide, high = right - left, bottom - top
        x, y = self._at(near)
        x, y = x - wide / 2, y - high / 2 - above * SMOOTH
        x = min(max(x, 2 * SMOOTH), self._image.width - wide - 2 * SMOOTH)
        step = 0.6 * high
        for shift in (0, -1, 1, -2, 2, -3, 3):
            box = (x, y + shift * step, x + wide, y + shift * step + high)
            if all(_apart(box, other) for other in self._written):
                break
        else:
            if not always:
                return
            box = (x, y, x + wide, y + high)
        self._written.append(box)
        self._draw.text(
            (box[0] - left, box[1] - top),
            content,
            color,
            font,
            stroke_width=round(1.5 * SMOOTH),
            stroke_fill=WHITE,
        )

    def _at(self, point: Point) -> tuple[float, float]:
        scale = self.scale * SMOOTH
        return (
            (float(point[0]) - float(self._low[0])) * scale,
            (float(self._high[1]) - float(point[1])) * scale,
        )


def _apart(a: tuple[float, float, float, float], b: tuple[float, float, float, float]) -> bool:
    return a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]


@cache
def _font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """The font that Pillow brings: the same on every machine."""
    return ImageFont.load_default(size)


def rgb(color: Sequence[float], factor: float = 1.0) -> Rgb:
    """A colour of a body, made darker (factor < 1) or lighter."""
    red, green, blue = (min(max(int(255 * channel * factor), 0), 255) for channel in color)
    return red, green, blue

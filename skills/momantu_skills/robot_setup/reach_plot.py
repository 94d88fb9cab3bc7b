"""A map of where a robot's hand reaches, from above and from the side, as a picture."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_bt.lazy import lazily
from momantu_bt.robot import RobotDescription
from momantu_skills.robot_setup.reach import CELL, Reach

with lazily():
    import cv2

_SCALE = 24
"""Pixels of a cell."""
_EDGE, _GAP, _KEY = 60, 40, 130
"""Pixels around a map, between the maps, and for the key."""
_FONT = 0.5
_INK, _GREY, _BLUE = (40, 40, 40), (190, 190, 190), (200, 90, 20)


def plot(robot: RobotDescription, found: Reach, band: tuple[float, float]) -> bytes:
    """A PNG. band: heights above the floor, m, that the map from above is about."""
    above = _Panel(found.band(*band), found.low[:2])
    said = f"{robot.name} from above, hand {band[0]:g} to {band[1]:g} m high"
    above.draw(said, "ahead (m)", "left (m)")
    outline = [above.pixel(x, y) for x, y in robot.footprint]
    cv2.polylines(above.canvas, [np.array(outline)], True, _INK, 2, cv2.LINE_AA)
    if robot.working.reach is not None:
        for radius in robot.working.reach:
            size = round(radius / CELL * _SCALE)
            cv2.circle(above.canvas, above.pixel(0, 0), size, _BLUE, 1, cv2.LINE_AA)
        _write(above.canvas, "circles: working.reach", (_EDGE, above.canvas.shape[0] - 8), _BLUE)
    beside = _Panel(found.side(), found.low[[0, 2]])
    beside.draw("from the right side", "ahead (m)", "up (m)")
    height = max(above.canvas.shape[0], beside.canvas.shape[0])
    panels = [_padded(each.canvas, height) for each in (above, beside)]
    gap = np.full((height, _GAP, 3), 255, dtype=np.uint8)
    return bytes(cv2.imencode(".png", np.hstack([panels[0], gap, panels[1], _key(height)]))[1])


class _Panel:
    """One map: shares (n, m), along its abscissa and its ordinate, from `low` (2,) m on."""

    def __init__(self, shares: Array, low: Array) -> None:
        self.shares, self.low = shares, low
        self.width, self.height = (n * _SCALE for n in shares.shape)
        shape = (self.height + 2 * _EDGE, self.width + 2 * _EDGE, 3)
        self.canvas: NDArray[np.uint8] = np.full(shape, 255, dtype=np.uint8)

    def pixel(self, x: float, y: float) -> tuple[int, int]:
        """Where a point, m, is drawn."""
        u, v = (np.array([x, y]) - self.low) / CELL * _SCALE
        return round(_EDGE + u), round(_EDGE + self.height - v)

    def draw(self, title: str, across: str, up: str) -> None:
        """The cells, a grid of half metres and what stands beside it."""
        for i, j in np.argwhere(self.shares > 0):
            x, y = self.low + np.array([i, j]) * CELL
            begin, end = self.pixel(x, y), self.pixel(x + CELL, y + CELL)
            cv2.rectangle(self.canvas, begin, end, _color(float(self.shares[i, j])), -1)
        for k, name in ((0, across), (1, up)):
            self._grid(k)
            place = (
                (_EDGE + self.width - 80, _EDGE + self.height + 44) if k == 0 else (4, _EDGE - 8)
            )
            _write(self.canvas, name, place)
        _write(self.canvas, title, (_EDGE, 22))

    def _grid(self, k: int) -> None:
        ends = self.low + np.array(self.shares.shape) * CELL
        for half in range(math.ceil(self.low[k] * 2), math.floor(ends[k] * 2) + 1):
            at = half / 2
            begin = (at, self.low[1]) if k == 0 else (self.low[0], at)
            end = (at, ends[1]) if k == 0 else (ends[0], at)
            cv2.line(self.canvas, self.pixel(*begin), self.pixel(*end), _GREY, 1)
            u, v = self.pixel(*begin)
            _write(self.canvas, f"{at:g}", (u - 10, v + 18) if k == 0 else (u - 40, v + 5))


def _color(share: float) -> tuple[int, int, int]:
    """From light yellow, one direction, to dark green, all of them; BGR."""
    low, high = np.array([170, 240, 255.0]), np.array([40, 110, 0.0])
    b, g, r = (low + (high - low) * share).round().astype(int).tolist()
    return b, g, r


def _key(height: int) -> NDArray[np.uint8]:
    canvas: NDArray[np.uint8] = np.full((height, _KEY, 3), 255, dtype=np.uint8)
    _write(canvas, "sides", (10, _EDGE - 8))
    for row, share in enumerate((0.1, 0.25, 0.5, 0.75, 1.0)):
        top = _EDGE + row * _SCALE
        cv2.rectangle(canvas, (10, top), (10 + _SCALE, top + _SCALE), _color(share), -1)
        _write(canvas, f"{100 * share:.0f} %", (20 + _SCALE, top + 17))
    return canvas


def _padded(canvas: NDArray[np.uint8], height: int) -> NDArray[np.uint8]:
    below = np.full((height - canvas.shape[0], canvas.shape[1], 3), 255, dtype=np.uint8)
    return np.vstack([canvas, below])


def _write(
    canvas: NDArray[np.uint8],
    text: str,
    place: tuple[int, int],
    color: tuple[int, int, int] = _INK,
) -> None:
    cv2.putText(canvas, text, place, cv2.FONT_HERSHEY_SIMPLEX, _FONT, color, 1, cv2.LINE_AA)

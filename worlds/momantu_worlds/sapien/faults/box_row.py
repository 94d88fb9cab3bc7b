"""Placing boxes so that only the wanted number of free spots is left beside a marker."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Pose2D
from momantu_worlds.scenes.arrange.layout import PlacedTable
from momantu_worlds.scenes.arrange.spots import (
    SPOT_GAP,
    Disc,
    SetDown,
    lane,
    seen_share,
    tag_points,
)
from momantu_worlds.scenes.geometry.plane import Rectangle, gap

SIZE, HEIGHT = 0.09, 0.06
"""Edge and height of a box, m: too low to hide a marker behind it from a standing robot."""
FINGERS = 0.06
"""A spot needs this much room around the object to be free, m: the fingers open beside it."""
CELL = 0.025
"""Grid of spots and of places for boxes, m."""
BETWEEN = 0.005
"""Least gap between boxes, and to the marker, m."""
MOST = 40


class BoxRow:
    """Chooses places greedily: each box where it covers most of the spots that are still free.

    wanted: the object to place. things: objects on the table. marker: its picture; both in the
    table's frame.
    """

    def __init__(
        self, wanted: SetDown, table: PlacedTable, things: list[Disc], marker: Rectangle
    ) -> None:
        self.wanted, self.things, self.marker = wanted, things, marker
        self._table = table
        self._kept: list[Disc] = []
        half = np.array(table.size) / 2
        xs, ys = (np.arange(-h + CELL, h, CELL) for h in half.tolist())
        self._cells = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)

    def keep(self, spots: Sequence[tuple[float, float]]) -> None:
        """Keep these spots free and reachable by the hand."""
        self._kept = [Disc(x, y, self.wanted.radius, self.wanted.height) for x, y in spots]

    def room(self, spot: tuple[float, float]) -> float:
        """Distance from a spot to the nearest thing or to the marker, m."""
        gaps = [math.hypot(spot[0] - d.x, spot[1] - d.y) - d.radius for d in self.things]
        return min([float(self.marker.distance(np.array(spot))), *gaps])

    def boxes(self, fits: Callable[[float, float], bool]) -> Iterator[tuple[float, float]]:
        """Centres (x, y) of boxes; `fits` tells whether the world has room for one there."""
        spots = self.beside()
        places = self._cells
        covers = _square_distance(places[:, None], spots[None]) < self.wanted.radius + FINGERS
        open_ = np.ones(len(places), dtype=np.bool_)
        left = np.ones(len(spots), dtype=np.bool_)
        placed: list[Disc] = []
        for _ in range(MOST):
            while True:
                gain = np.where(open_, (covers & left).sum(axis=1), 0)
                best = int(np.argmax(gain))
                if gain[best] == 0:
                    return
                x, y = (float(v) for v in places[best])
                open_[best] = False
                if self._harmless(x, y, placed) and fits(x, y):
                    break
            placed.append(_disc(x, y))
            left &= ~covers[best]
            open_ &= np.abs(places - (x, y)).max(axis=1) >= SIZE + BETWEEN
            yield x, y

    def beside(self) -> Array:
        """Spots (n, 2) beside the marker that are free now: on the top, with room for fingers."""
        cells, wanted = self._cells, self.wanted
        half = np.array(self._table.size) / 2 - wanted.radius
        from_marker = np.hypot(*(cells - (self.marker.pose.x, self.marker.pose.y)).T)
        free: NDArray[np.bool_] = np.all(np.abs(cells) <= half, axis=1)
        free &= from_marker <= wanted.distance
        free &= self.marker.distance(cells) >= wanted.radius
        for disc in self.things:
            away = np.hypot(*(cells - (disc.x, disc.y)).T) - disc.radius
            free &= away >= wanted.radius + FINGERS
        if self._table.round:
            free &= np.hypot(*cells.T) <= half[0]
        return np.asarray(cells[free])

    def _harmless(self, x: float, y: float, placed: list[Disc]) -> bool:
        """Whether the marker stays visible as before, and the kept spots free and reachable."""
        box = Rectangle(Pose2D(x, y), (SIZE + 2 * BETWEEN, SIZE + 2 * BETWEEN))
        if gap(box, self.marker) == 0.0:
            return False
        discs = [*self.things, *placed, _disc(x, y)]
        apart = self.wanted.radius + SPOT_GAP + discs[-1].radius
        return (
            all(math.hypot(x - kept.x, y - kept.y) >= apart for kept in self._kept)
            and all(lane(kept, discs, self.wanted.side) for kept in self._kept)
            and self._seen(discs) >= self._seen(self.things)
        )

    def _seen(self, discs: list[Disc]) -> float:
        corner = math.hypot(*self.marker.size) / 2
        at = self.marker.pose
        target = Disc(at.x, at.y, corner, 0.0)
        points = tag_points(at, corner)
        return seen_share(points, discs, self._table, self.wanted.side, target)


def _disc(x: float, y: float) -> Disc:
    return Disc(x, y, SIZE / math.sqrt(2.0), HEIGHT)


def _square_distance(middles: Array, points: Array) -> Array:
    """Distance (...) of points (..., 2) from square boxes around `middles`, 0 inside, m."""
    out = np.maximum(np.abs(points - middles) - SIZE / 2, 0.0)
    return np.asarray(np.hypot(out[..., 0], out[..., 1]))

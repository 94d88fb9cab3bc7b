"""How far along the fingers a round thing is held so that they press through its axis."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.robot import EndEffector

FIRM = math.radians(20)
"""Largest lean of the forces on a held thing, rad: of most pairs of materials the friction, 0.36 or
more, holds it. What leans more is held elsewhere if it is `SQUARE` there."""
SQUARE = math.radians(12)
"""Largest lean where a thing is moved to, and a `STEP` from there, rad."""
STEP = 0.003
"""Step along the fingers, m: the error of a detection. A rounded tip presses through the axis of a
thing at one place alone, and beside it leans."""
LOOKED = math.radians(60)
"""How far from the closing direction fingers may touch, rad."""
ANGLES = np.linspace(-LOOKED, LOOKED, 61)
"""Directions in which they may, from the thing's axis, rad."""
HEIGHTS = np.linspace(-0.5, 0.5, 5)
"""Heights at which fingers are looked at, as shares of the pads' height."""
HALVINGS = 8
"""Bisections of the opening: 0.4 mm of 0.1 m."""
SAME = 1e-5
"""Difference of distances, m, up to which points are touched together, as a face touches."""

Closing = Callable[[float], Sequence[Array]]
"""Planes (k, 4) around each finger at an opening, m; see `ArmModel.fingers_at`."""


class Seat:
    """Where fingers touch an upright cylinder, by how far the grasp frame is behind its axis.

    Two fingers push along the surface's normals. Where those lean, as at an edge of a pad before or
    behind the thing's middle, they push it along the fingers too. Friction must take that up: a
    thing at the end of its friction slides and turns, whatever the force.
    """

    def __init__(self, hand: EndEffector, radius: float, closing: Closing) -> None:
        """radius: the cylinder's, m."""
        self._hand, self._radius, self._closing = hand, radius, cache(closing)
        self._leans: dict[float, float] = {}

    def best(self, back: float, farthest: float) -> float:
        """`back`, m, or, where that is not firm, a distance up to `farthest` that is square."""
        if self.lean(back) <= FIRM:
            return back
        places = np.arange(back, farthest + 1e-9, STEP).tolist()
        around = zip(places, places[1:], places[2:], strict=False)
        worst = {three[1]: max(map(self.lean, three)) for three in around}
        least = min(worst, key=worst.__getitem__, default=back)
        return least if worst.get(least, math.inf) <= SQUARE else back

    def lean(self, back: float) -> float:
        """The larger angle, rad, of both sides' forces from the closing direction."""
        place = round(back, 4)
        if place not in self._leans:
            self._leans[place] = self._measured(place)
        return self._leans[place]

    def _measured(self, back: float) -> float:
        sides = [self._outline(back, side) for side in (1.0, -1.0)]
        apart, together = self._hand.max_width, 0.0
        for _ in range(HALVINGS):
            middle = (apart + together) / 2
            touching = any(gap.min() <= 0.0 for gap in self._gaps(sides, middle))
            apart, together = (apart, middle) if touching else (middle, together)
        return max(_nearest(gap) for gap in self._gaps(sides, apart))

    def _outline(self, back: float, side: float) -> Array:
        """Points (angles, heights, 3) of the cylinder's one side, in the grasp frame."""
        x = back + self._radius * np.sin(ANGLES)
        y = side * self._radius * np.cos(ANGLES)
        z = HEIGHTS * self._hand.pad_height
        shape = (len(ANGLES), len(HEIGHTS))
        columns = (np.broadcast_to(v, shape) for v in (x[:, None], y[:, None], z[None]))
        return np.stack(list(columns), axis=-1)

    def _gaps(self, sides: Sequence[Array], width: float) -> list[Array]:
        """Distance (angles,) of the fingers from each side at an opening, m; negative inside."""
        fingers = self._closing(width)
        return [
            np.min([(p @ f[:, :3].T + f[:, 3]).max(axis=2).min(axis=1) for f in fingers], axis=0)
            for p in sides
        ]


def _nearest(gaps: Array) -> float:
    """The least angle, rad, at which a side is touched."""
    return float(np.abs(ANGLES[gaps <= gaps.min() + SAME]).min())

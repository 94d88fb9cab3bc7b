"""Grasps of a mug by its handle: where a picture shows one, it is pinched from both sides."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import DetectedObject
from momantu_bt.robot import EndEffector
from momantu_skills.manipulation.hand.grasps import (
    ROOM,
    TILT_PENALTY,
    Grasp,
    both_ways,
    clear_of,
    setback,
    surface_of,
)

BESIDE, FARTHEST = 0.008, 0.05
"""From where to where outside the body's side points show a handle, m: beyond the error of the
radius and the noise; farther away other things stand."""
BOTTOM, TOP = 0.014, 0.006
"""Heights above the lower and below the upper end of the body within which they do not count, m:
those of the surface, and of the rim."""
FEW = 10
"""Fewest points of a handle: every second pixel in each direction of one picture shows 80 of one at
1 m; of one behind its mug a picture from above shows some."""
ONE_SIDE = 0.85
"""Least length of the mean of their directions: they lie on one side of the body."""
STANDS_OUT = 0.015
"""How far a handle stands out from the body at least, m."""
OUTSIDE = 95.0
"""Percentile of the points' distances that is its outside: noise is beyond."""
TALL = 0.045
"""Height of a handle of which only the upper end is seen, m."""
THICK = 0.014
"""Assumed thickness of a handle between the pads, m: the fingers are so far apart when they have
to clear the body."""
ASIDE = 0.025
"""Room that a handle takes beside its middle, m: its thickness, and the error of its bearing."""
OVERLAP = 0.014
"""Length of the handle that must be between the pads, m."""
SHARES = (0.5, 0.7, 0.3)
"""Heights of the grasp, as shares of the handle's."""
TILTS = tuple(math.radians(angle) for angle in (0.0, 15.0, 30.0, 50.0, 70.0, 90.0, 105.0, 120.0))
"""Angles of the fingers below the horizontal, rad: from the handle's outside, from above, and over
the body."""
OUTER = 0.005
"""How far within a handle's outside the pads' middle may be, m: so the pads are beside the body."""
EDGE = 60.0
"""Cost, s per metre, of holding it nearer to its outside than in the middle."""
ASKEW = 4.0
"""Cost, s per unit share, of holding a handle beside its middle."""


@dataclass(frozen=True)
class Handle:
    """Where a handle stands out. bearing: about the object's axis, rad.

    outer: distance of its outside from the axis, m. low, high: its ends along the axis in the
    object's frame, m.
    """

    bearing: float
    outer: float
    low: float
    high: float

    def corners(self, radius: float) -> Array:
        """Corners (8, 3) of a box around it in the object's frame, m. radius: of the body."""
        ends = product((radius, self.outer), (-ASIDE / 2, ASIDE / 2), (self.low, self.high))
        c, s = math.cos(self.bearing), math.sin(self.bearing)
        return np.asarray(
            np.array(list(ends)) @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        )


def seen_handle(points: Array, thing: DetectedObject) -> Handle | None:
    """The handle of an upright round object that points (n, 3) of pictures, odom, show."""
    if thing.shape != "cylinder":
        return None
    local = thing.pose.transform.inverse().apply(points)
    radius, half = max(thing.size[:2]) / 2, thing.size[2] / 2
    away = np.hypot(local[:, 0], local[:, 1])
    near = (away > radius + BESIDE) & (away < radius + FARTHEST)
    near &= (local[:, 2] > -half + BOTTOM) & (local[:, 2] < half - TOP)
    found, away = local[near], away[near]
    if len(found) < FEW:
        return None
    x, y = (found[:, :2] / away[:, None]).mean(axis=0).tolist()
    low, high = float(found[:, 2].min()), float(found[:, 2].max())
    outer = float(np.percentile(away, OUTSIDE))
    if math.hypot(x, y) < ONE_SIDE or outer < radius + STANDS_OUT:
        return None
    return Handle(math.atan2(y, x), outer, max(-half + BOTTOM, min(low, high - TALL)), high)


def handle_grasps(
    thing: DetectedObject,
    handle: Handle,
    hand: EndEffector,
    palm: Array,
    closing: Callable[[float], Sequence[Array]],
) -> list[Grasp]:
    """Grasps with the handle's flat sides between the pads, from its outside and from above.

    palm, closing: see `grasps_for`.
    """
    return both_ways(_grasps(thing, handle, hand, palm, closing(THICK)))


def _grasps(
    thing: DetectedObject,
    handle: Handle,
    hand: EndEffector,
    palm: Array,
    fingers: Sequence[Array],
) -> Iterator[Grasp]:
    surface, radius = surface_of(thing), max(thing.size[:2]) / 2
    out = np.array([math.cos(handle.bearing), math.sin(handle.bearing), 0.0])
    y = np.array([-out[1], out[0], 0.0])
    middles = ((radius + handle.outer) / 2, handle.outer - OUTER)
    for tilt, share, away in product(TILTS, SHARES, middles):
        x = -math.cos(tilt) * out + np.array([0.0, 0.0, -math.sin(tilt)])
        rotation = np.stack([x, y, np.cross(x, y)], axis=1)
        height = handle.low + share * (handle.high - handle.low)
        centre = away * out + np.array([0.0, 0.0, height])
        local = (surface - centre) @ rotation
        # how far the handle reaches from its middle towards the palm
        depth = abs(math.cos(tilt)) * (handle.outer - radius) + math.sin(tilt) * (
            handle.high - handle.low
        )
        farthest = depth / 2 + hand.pad_length / 2 - OVERLAP
        back = clear_of(local, fingers, ROOM, setback(local, hand, palm), farthest)
        if back is None:
            continue
        penalty = TILT_PENALTY * tilt + ASKEW * abs(share - SHARES[0])
        penalty += EDGE * (away - middles[0])
        place = Transform.from_rotation(rotation, centre - back * x)
        yield Grasp(place, THICK, penalty, "handle")

"""Loose bodies that begin deep in others: held where they are, as physics would throw them out."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import QhullError

from momantu_bt.geometry import Array
from momantu_worlds.scenes.geometry.convex import hull_of
from momantu_worlds.sdf.body.bodies import ImportedBody
from momantu_worlds.sdf.deviations import Deviations

WEDGED = 0.03
"""Depth, m, from which a loose body is held: more than what things overlap by that were laid on
each other carelessly."""


@dataclass(frozen=True, eq=False)
class _Solids:
    """hulls: points (n, 3) of each. low, high: (k, 3) of the boxes around them, m."""

    body: ImportedBody
    hulls: tuple[Array, ...]
    low: Array
    high: Array


def held_where_wedged(bodies: Sequence[ImportedBody], deviations: Deviations) -> list[ImportedBody]:
    """The same bodies; loose ones that reach more than WEDGED into one that stands still stay.

    A saved world often has furniture that was pushed into a wall.
    """
    still = [
        _solids(body) for body in bodies if body.still and next(body.hulls(), None) is not None
    ]
    return [body if body.still else _judged(body, still, deviations) for body in bodies]


def _judged(body: ImportedBody, still: Sequence[_Solids], deviations: Deviations) -> ImportedBody:
    own = _solids(body)
    for other in still:
        depth = _depth(own, other)
        if depth > WEDGED:
            what = f"it begins {depth:.3f} m in {other.body.title}"
            instead = "it stays there, as it would be thrown out"
            deviations.changed(body.place, body.title, what, instead)
            return replace(body, still=True, mass=None)
    return body


def _solids(body: ImportedBody) -> _Solids:
    hulls = tuple(body.hulls())
    low = np.array([hull.min(axis=0) for hull in hulls]).reshape(-1, 3)
    high = np.array([hull.max(axis=0) for hull in hulls]).reshape(-1, 3)
    return _Solids(body, hulls, low, high)


def _depth(own: _Solids, other: _Solids) -> float:
    """How deep two bodies overlap at the worst of their hulls, m; flat ones count as nothing."""
    deepest = 0.0
    for k, hull in enumerate(own.hulls):
        meet = (own.high[k] - WEDGED > other.low) & (other.high - WEDGED > own.low[k])
        for i in np.flatnonzero(meet.all(axis=1)).tolist():
            with suppress(QhullError):
                deepest = max(deepest, hull_of(hull).depth(hull_of(other.hulls[i])))
    return deepest

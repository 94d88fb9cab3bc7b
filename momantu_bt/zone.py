"""Zones of a site: parts of the floor to keep out of, to drive slowly in, or to prefer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np

from momantu_bt.geometry import Array

ZoneKind: TypeAlias = Literal["keep_out", "slow", "preferred"]
"""keep_out: the footprint never enters. slow: a speed limit holds. preferred: ways cost less."""
ZONE_KINDS: tuple[ZoneKind, ...] = get_args(ZoneKind)


@dataclass(frozen=True, slots=True)
class Zone:
    """A simple polygon on the floor.

    corners: (x, y) in the map, m, one after the other around it, either way. speed: the limit in a
    slow zone, m/s; None in others.
    """

    kind: ZoneKind
    corners: tuple[tuple[float, float], ...]
    speed: float | None = None

    def distance(self, points: Array) -> Array:
        """Distance (n,) of points (n, 2) of the map from its border, m; below 0 inside."""
        xy = np.asarray(points, dtype=np.float64)[:, None, :]
        first = np.array(self.corners, dtype=np.float64)
        last = np.roll(first, -1, axis=0)
        along = last - first
        share = ((xy - first) * along).sum(axis=2) / (along**2).sum(axis=1)
        nearest = first + np.clip(share, 0.0, 1.0)[..., None] * along
        away = np.sqrt(((xy - nearest) ** 2).sum(axis=2)).min(axis=1)
        return np.asarray(np.where(self._inside(xy, first, last), -away, away))

    @staticmethod
    def _inside(xy: Array, first: Array, last: Array) -> Array:
        """Whether a ray from each point (n, 1, 2) towards +x crosses an odd number of sides."""
        x, y = xy[..., 0], xy[..., 1]
        spans = (first[:, 1] > y) != (last[:, 1] > y)
        rise = np.where(spans, last[:, 1] - first[:, 1], 1.0)
        at = first[:, 0] + (y - first[:, 1]) / rise * (last[:, 0] - first[:, 0])
        return np.asarray((spans & (x < at)).sum(axis=1) % 2 == 1)

    def border(self, spacing: float) -> Array:
        """Points (n, 2) along its border, at most `spacing` m apart."""
        corners = np.array(self.corners, dtype=np.float64)
        sides = zip(corners, np.roll(corners, -1, axis=0), strict=True)
        return np.concatenate(
            [
                np.linspace(a, b, max(1, int(np.ceil(np.hypot(*(b - a)) / spacing))), False)
                for a, b in sides
            ]
        )

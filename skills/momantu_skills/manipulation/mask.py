"""Which points lie on the robot, and the outline it throws on the floor."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from momantu_bt.geometry import Array

_SIDES = np.array(
    [
        *((1, 0, 0), (0, 1, 0), (0, 0, 1)),
        *((1, 1, 0), (1, -1, 0), (1, 0, 1), (1, 0, -1), (0, 1, 1), (0, 1, -1)),
        *((1, 1, 1), (1, 1, -1), (1, -1, 1), (-1, 1, 1)),
    ],
    dtype=np.float64,
)
DIRECTIONS = _SIDES / np.linalg.norm(_SIDES, axis=1, keepdims=True)
"""(13, 3): the slabs between which a link is enclosed (a 26-DOP, Klosowski et al. 1998)."""


class LinkMask:
    """Encloses hulls in slabs, to tell quickly which points lie within."""

    def __init__(self, hulls: Mapping[str, Array], padding: float) -> None:
        self.names = tuple(hulls)
        self._low = np.array([(h @ DIRECTIONS.T).min(axis=0) for h in hulls.values()]) - padding
        self._high = np.array([(h @ DIRECTIONS.T).max(axis=0) for h in hulls.values()]) + padding
        self._centres = np.array([(h.min(axis=0) + h.max(axis=0)) / 2 for h in hulls.values()])
        spread = zip(hulls.values(), self._centres, strict=True)
        self._radii = np.array([np.linalg.norm(h - c, axis=1).max() for h, c in spread])
        self._radii += padding

    def covers(self, points: Array, poses: Mapping[str, Array]) -> NDArray[np.bool_]:
        """(n,) which points (n, 3) lie within a link at its pose base_from_link (4, 4)."""
        inside = np.zeros(len(points), dtype=bool)
        for i, name in enumerate(self.names):
            pose = poses[name]
            centre = pose[:3, :3] @ self._centres[i] + pose[:3, 3]
            offsets = points - centre
            near = np.einsum("ij,ij->i", offsets, offsets) < self._radii[i] ** 2
            near &= ~inside
            candidates = np.flatnonzero(near)
            if not len(candidates):
                continue
            local = (points[candidates] - pose[:3, 3]) @ pose[:3, :3]
            along = local @ DIRECTIONS.T
            inside[candidates] = ((along >= self._low[i]) & (along <= self._high[i])).all(axis=1)
        return inside


def floor_outline(corners: Array) -> Array:
    """Convex outline (k, 2), counter-clockwise, of corners (n, 3) projected onto the floor."""
    flat = corners[:, :2]
    return np.asarray(flat[ConvexHull(flat).vertices])

"""Whether a part's hull would fill free space: a room, the space below a table."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import trimesh
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_bt.world import seeded
from momantu_worlds.scenes.geometry.hulls import HullMesh

SAMPLES = 300
"""Number of sample points in a hull."""
CORNERS = 8
"""Each sample is a random mixture of this many corners of the hull."""
EVENNESS = 0.6
"""Evenness of the mixture (Dirichlet's alpha)."""
INWARD = 0.95
"""Factor by which samples are moved towards the centre: on a face visibility is ambiguous."""
AIR = 0.15
"""Share of samples in the air above which a part is hollow."""
ROOM = (2.0, 2.0, 1.5)
"""Extents above which a part is a building, m, whatever the orientation of its faces."""
UP = (0.0, 0.0, 1.0)
_FLAT = [(np.cos(a), np.sin(a), 0.0) for a in np.arange(8) * np.pi / 4 + 0.1]
DIRECTIONS = np.array([UP, *_FLAT])
"""Directions (9, 3) of the view from a point: up and around. Parts without a bottom are not
hollow."""


def is_building(vertices: Array) -> bool:
    """Whether a part with some vertices (n, 3) is large enough to be one."""
    return bool((np.ptp(vertices, axis=0) > ROOM).all())


class Air:
    """Tests whether points within a mesh are in free air.

    A point is in the air if it has a free view to the sky, or if most faces around it face it:
    inside matter only the backs of faces are visible.
    """

    def __init__(self, parts: Sequence[tuple[Array, NDArray[np.int64]]]) -> None:
        offsets = np.cumsum([0, *(len(vertices) for vertices, _ in parts)])
        self._mesh = trimesh.Trimesh(
            np.concatenate([vertices for vertices, _ in parts]),
            np.concatenate([t + o for (_, t), o in zip(parts, offsets, strict=False)]),
            process=False,
        )

    def fills(self, hull: HullMesh) -> bool:
        """Whether a large share of a hull is air."""
        vertices = hull.vertices
        if is_building(vertices):
            return True
        draw = seeded("hollow", len(vertices))
        picked = vertices[draw.integers(len(vertices), size=(SAMPLES, CORNERS))]
        weights = draw.dirichlet(np.full(CORNERS, EVENNESS), SAMPLES)
        points = np.einsum("ij,ijk->ik", weights, picked)
        middle = vertices.mean(axis=0)
        points = middle + INWARD * (points - middle)
        return float(self._in_air(points).mean()) > AIR

    def _in_air(self, points: Array) -> NDArray[np.bool_]:
        origins = np.repeat(points, len(DIRECTIONS), axis=0)
        rays = np.tile(DIRECTIONS, (len(points), 1))
        hit = self._mesh.ray.intersects_first(origins, rays)
        facing = np.einsum("ij,ij->i", self._mesh.face_normals[hit], rays) < 0.0
        free = ((hit < 0) | facing).reshape(len(points), -1)
        sky = (hit < 0).reshape(len(points), -1)[:, 0]
        return np.asarray(sky | (free.mean(axis=1) > 0.5))

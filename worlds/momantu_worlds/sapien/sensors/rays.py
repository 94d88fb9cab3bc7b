"""Casting many rays at triangles."""

from __future__ import annotations

import numpy as np
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh

from momantu_bt.geometry import Array

NOTHING = 1e6
"""Distance above which a ray has hit nothing, m."""


class Triangles:
    """Targets of rays. triangles: (k, 3, 3) in one frame, m."""

    def __init__(self, triangles: Array) -> None:
        self._scene = rtcore_scene.EmbreeScene()
        self._mesh = TriangleMesh(self._scene, triangles.astype(np.float32))

    def distances(self, origin: Array, directions: Array) -> Array:
        """Distances along unit rays (n, 3) from one point (3,), or from points (n, 3), m.

        Infinite if nothing is hit.
        """
        origins = np.broadcast_to(origin, directions.shape)
        hit = self._scene.run(
            origins.astype(np.float32), directions.astype(np.float32), query="DISTANCE"
        )
        distances = np.asarray(hit, dtype=np.float64)
        distances[distances > NOTHING] = np.inf
        return distances

"""Moving bodies, as the laser sees them."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.lazy import lazily
from momantu_worlds.sapien.build.meshes import TriangleMesh
from momantu_worlds.sapien.poses import transform_of

with lazily():
    import trimesh

KEPT = 32
"""How many cuts of a body at rest are kept: the height of a scanner hardly changes."""

TOUCHES = 1e-6
"""Distance from the plane, m, within which trimesh decides whether a vertex lies in it."""


class MovingBody:
    """A loose body and its outline in a horizontal plane."""

    def __init__(self, entity: Any, mesh: TriangleMesh) -> None:
        self._entity, self._mesh = entity, mesh
        self._radius = float(np.linalg.norm(mesh.vertices, axis=1).max())
        self._cut_at = b""
        self._cuts: dict[float, Array] = {}

    @cached_property
    def _solid(self) -> trimesh.Trimesh:
        return trimesh.Trimesh(*self._mesh, process=False)

    def ball(self) -> tuple[Array, float]:
        """Centre (3,) in the map and radius of a ball around the body, m."""
        return np.asarray(self._entity.pose.p, dtype=np.float64), self._radius

    def triangles(self) -> Array:
        """Its triangles (k, 3, 3) in the map, at its current pose."""
        return transform_of(self._entity.pose).apply(self._mesh.triangles)

    def cut(self, origin: Array, reach: float) -> Array:
        """Segments (k, 2, 2) in the map where the plane z = origin[2] cuts the body.

        There are none if the body is entirely above or below the plane, or farther than `reach` m
        from `origin`.
        """
        pose = self._entity.pose
        position = np.asarray(pose.p, dtype=np.float64)
        far = float(np.hypot(*(position[:2] - origin[:2]))) > reach + self._radius
        if far or abs(position[2] - origin[2]) > self._radius:
            return np.zeros((0, 2, 2))
        at, height = pose.p.tobytes() + pose.q.tobytes(), float(origin[2])
        if at != self._cut_at or len(self._cuts) > KEPT:
            self._cut_at, self._cuts = at, {}
        if height not in self._cuts:
            self._cuts[height] = self._cut(transform_of(pose), height)
        return self._cuts[height]

    def _cut(self, map_from_body: Transform, height: float) -> Array:
        origin = map_from_body.inverse().apply(np.array([0.0, 0.0, height]))
        normal = map_from_body.rotation.T[:, 2]
        heights = np.dot(self._mesh.vertices - origin, normal)
        if heights.min() > TOUCHES or heights.max() < -TOUCHES:
            return np.zeros((0, 2, 2))  # most bodies: trimesh need not be loaded
        cut: Any = trimesh.intersections.mesh_plane
        lines = cut(self._solid, normal, origin)
        return np.asarray(map_from_body.apply(lines)[..., :2])

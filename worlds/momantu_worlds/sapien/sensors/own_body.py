"""The robot's own links, as its sensors see them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import sapien

from momantu_bt.geometry import Array, Transform, quaternion_from_axis_angle
from momantu_bt.lazy import lazily
from momantu_worlds.sapien.build.meshes import CYLINDER_SIDES
from momantu_worlds.sapien.poses import transform_of

with lazily():
    import trimesh

ALONG_X = Transform((0, 0, 0), quaternion_from_axis_angle((0, 1, 0), np.pi / 2)).matrix
"""trimesh's cylinders stand along z, SAPIEN's lie along x."""


class OwnBody:
    """The collision shapes of a robot, as triangles in the frame of one of its links."""

    def __init__(self, links: Iterable[Any]) -> None:
        meshes = [(link, _mesh(link)) for link in links]
        self._links = [(link, mesh.triangles) for link, mesh in meshes if mesh is not None]

    def poses(self, map_from_frame: Transform) -> Array:
        """Poses of all links relative to a frame: (n, 7) positions and quaternions."""
        frame_from_map = map_from_frame.inverse()
        seen = [frame_from_map @ transform_of(link.entity_pose) for link, _ in self._links]
        return np.array([[*pose.position, *pose.quaternion] for pose in seen]).reshape(-1, 7)

    def triangles(self, poses: Array) -> Array:
        """All triangles (k, 3, 3) with the links at these poses, in the same frame."""
        placed = [
            Transform(pose[:3], pose[3:]).apply(triangles)
            for pose, (_, triangles) in zip(poses, self._links, strict=True)
        ]
        return np.concatenate(placed) if placed else np.zeros((0, 3, 3))


def housing(link: Any) -> Any:
    """The link around a sensor's frame: the frame's own, or the nearest above it with a shape."""
    while not link.collision_shapes and link.parent is not None:
        link = link.parent
    return link


def _mesh(link: Any) -> Any:
    """All collision shapes of a link in the link's frame, a trimesh.Trimesh; None without any."""
    parts = []
    for shape in link.collision_shapes:
        mesh = _shape_mesh(shape)
        mesh.apply_transform(transform_of(shape.local_pose).matrix)
        parts.append(mesh)
    return trimesh.util.concatenate(parts) if parts else None


def _shape_mesh(shape: Any) -> Any:
    physx = sapien.physx
    if isinstance(shape, physx.PhysxCollisionShapeBox):
        return trimesh.creation.box(extents=2.0 * np.asarray(shape.half_size))
    if isinstance(shape, physx.PhysxCollisionShapeCylinder):
        return trimesh.creation.cylinder(
            radius=shape.radius,
            height=2.0 * shape.half_length,
            sections=CYLINDER_SIDES,
            transform=ALONG_X,
        )
    if isinstance(shape, physx.PhysxCollisionShapeSphere):
        return trimesh.creation.icosphere(subdivisions=2, radius=shape.radius)
    if isinstance(shape, physx.PhysxCollisionShapeCapsule):
        return trimesh.creation.capsule(
            radius=shape.radius, height=2.0 * shape.half_length, transform=ALONG_X
        )
    vertices = np.asarray(shape.vertices) * np.asarray(shape.scale)
    return trimesh.convex.convex_hull(vertices)

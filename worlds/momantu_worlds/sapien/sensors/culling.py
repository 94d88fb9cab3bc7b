"""Skipping shapes outside a camera's view, without a change of the picture."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

import numpy as np
import sapien

from momantu_bt.geometry import Array, Transform
from momantu_bt.robot import CameraSensor
from momantu_worlds.sapien.build.render_shapes import drawn_vertices
from momantu_worlds.sapien.poses import transform_of


class Culling:
    """Bounding spheres of a robot's links, tested against the four sides of a camera's view.

    Most triangles of a scene are the robot's, and its own head camera sees few of them.
    """

    def __init__(self, links: list[Any], sensor: CameraSensor) -> None:
        kind = sapien.render.RenderBodyComponent
        found = [link.entity.find_component_by_type(kind) for link in links]
        self._bodies = [body for body in found if body is not None]
        self._pictured = False
        half = sensor.horizontal_fov / 2
        tall = math.atan(math.tan(half) * sensor.height / sensor.width)
        # inward normals of the right and the lower side, of which the others are mirror images
        self._right = np.array([-math.cos(half), math.sin(half)])
        self._lower = np.array([-math.cos(tall), math.sin(tall)])

    @cached_property
    def _spheres(self) -> tuple[list[Array], Array]:
        """Centres and radii, m; computed with the second picture, when all meshes are loaded."""
        spheres = [_sphere(body) for body in self._bodies]
        return [center for center, _ in spheres], np.array([radius for _, radius in spheres])

    def outside(self, map_from_optical: Transform) -> list[Any]:
        """Render components that the camera cannot see from this pose; none for a first picture."""
        if not self._bodies:
            return []
        if not self._pictured:  # the renderer now loads all meshes at once, in several threads
            self._pictured = True
            return []
        around, radii = self._spheres
        centers = np.array(
            [
                transform_of(body.entity_pose).apply(center)
                for body, center in zip(self._bodies, around, strict=True)
            ]
        )
        x, y, z = map_from_optical.inverse().apply(centers).T
        within_width = self._right[0] * np.abs(x) + self._right[1] * z
        within_height = self._lower[0] * np.abs(y) + self._lower[1] * z
        hidden = (z < -radii) | (within_width < -radii)
        hidden |= within_height < -radii
        return [body for body, gone in zip(self._bodies, hidden, strict=True) if gone]


def _sphere(body: Any) -> tuple[Array, float]:
    """Centre (3,) in the entity's frame and radius of a sphere around all visual shapes, m."""
    points = np.concatenate(
        [vertices for shape in body.render_shapes for vertices in drawn_vertices(shape)]
    )
    center = (points.min(axis=0) + points.max(axis=0)) / 2
    return center, float(np.linalg.norm(points - center, axis=1).max())

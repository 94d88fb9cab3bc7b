"""The space that the robot occupies: one upright prism around each of its links."""

from __future__ import annotations

from typing import Any

import numpy as np
import sapien

from momantu_bt.geometry import Array, Pose2D
from momantu_worlds.sapien.build.robot_model import RobotModel
from momantu_worlds.sapien.poses import transform_of
from momantu_worlds.scenes.geometry.prisms import Prism, prism_around
from momantu_worlds.scenes.geometry.solids import CORNERS


class RobotRoom:
    """Points of each link's collision shapes, computed once."""

    def __init__(self, model: RobotModel) -> None:
        self._links = [
            (link, np.concatenate([_points(shape) for shape in link.collision_shapes]))
            for link in model.links.values()
            if link.collision_shapes
        ]

    def prisms(self, base: Pose2D, elsewhere: Pose2D | None = None) -> list[Prism]:
        """The prisms now, or with the base, now at `base`, moved to `elsewhere`."""
        target = base if elsewhere is None else elsewhere
        move = target.transform() @ base.transform().inverse()
        return [
            prism_around((move @ transform_of(link.entity_pose)).apply(points), target.yaw)
            for link, points in self._links
        ]


def _points(shape: Any) -> Array:
    """Points (n, 3) in the link's frame with a convex hull around a collision shape."""
    physx = sapien.physx
    if isinstance(shape, physx.PhysxCollisionShapeConvexMesh):
        own = np.asarray(shape.vertices, dtype=np.float64) * np.asarray(shape.scale)
    elif isinstance(shape, physx.PhysxCollisionShapeBox):
        own = 2 * CORNERS * np.asarray(shape.half_size, dtype=np.float64)
    elif isinstance(shape, physx.PhysxCollisionShapeSphere):
        own = 2 * CORNERS * shape.radius
    elif isinstance(shape, physx.PhysxCollisionShapeCylinder | physx.PhysxCollisionShapeCapsule):
        cap = shape.radius if isinstance(shape, physx.PhysxCollisionShapeCapsule) else 0.0
        own = 2 * CORNERS * (shape.half_length + cap, shape.radius, shape.radius)
    else:
        raise TypeError(f"a {type(shape).__name__} takes up no room that is known")
    return transform_of(shape.local_pose).apply(own)

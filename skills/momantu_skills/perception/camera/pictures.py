"""The points of a picture within a region, without those on the robot itself."""

from __future__ import annotations

import numpy as np

from momantu_bt.detector import View
from momantu_bt.service import PlanningScene, Snapshot
from momantu_skills.perception.camera.cloud import points_from_depth
from momantu_skills.perception.geometry.regions import Region

STRIDE = 2
"""Pixels between two samples: a can 1 m away still gives 700 points."""


def see(snapshot: Snapshot, region: Region, scene: PlanningScene, stride: int = STRIDE) -> View:
    """The snapshot's points in `region` that are neither on the robot nor on its held object."""
    image = snapshot.image
    optical = points_from_depth(image.depth, image.intrinsics, stride)
    rotation, position = snapshot.odom_from_camera.rotation, snapshot.odom_from_camera.position
    height = optical @ rotation[2] + position[2]
    points = snapshot.odom_from_camera.apply(
        optical[(height >= region.low) & (height <= region.high)]
    )
    points = points[region.contains(points)]
    if len(points):
        base = snapshot.odom_from_base.inverse().apply(points)
        points = points[~np.asarray(scene.is_robot(base, snapshot.state), dtype=bool)]
    return View(snapshot, points)

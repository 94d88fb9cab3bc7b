"""One look: a picture, where it was taken from, and the points in it that matter."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from momantu_bt.frames import ODOM
from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import CameraImage, RobotState
from momantu_bt.robot import CameraSensor, Robot, read_camera
from momantu_bt.service import PlanningScene
from momantu_bt.skill import Skill
from momantu_skills.perception.cloud import points_from_depth
from momantu_skills.perception.regions import Region

STRIDE = 2
"""Pixels between two samples: a can 1 m away still has 700 points."""
OVERLAP = 0.7
"""Share of the field of view by which neighbouring views of a sweep are apart at most."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A picture with what was true when it was taken."""

    image: CameraImage
    odom_from_camera: Transform
    odom_from_base: Transform
    state: RobotState


@dataclass(frozen=True, slots=True)
class View:
    """A snapshot and its points (n, 3) in odom, m: in the region asked, the robot taken out."""

    snapshot: Snapshot
    points: Array

    @property
    def camera(self) -> Array:
        """Where the camera was, (3,) in odom, m."""
        return self.snapshot.odom_from_camera.position


def take(skill: Skill, robot: Robot) -> Snapshot:
    """Read the robot's first camera and look up where it was at the picture's stamp."""
    image = read_camera(robot)
    return Snapshot(
        image,
        skill.frames.lookup(ODOM, image.frame, image.stamp),
        skill.frames.lookup(ODOM, robot.description.base_frame, image.stamp),
        robot.state(),
    )


def see(snapshot: Snapshot, region: Region, scene: PlanningScene, stride: int = STRIDE) -> View:
    """The snapshot's points inside `region` that lie neither on the robot nor on what it holds."""
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


def sweep(
    corners_odom: Array, camera_odom: Array, camera: CameraSensor, at_least: int
) -> list[Array]:
    """Points (3,) to look at, one after the other, so that a surface is seen whole.

    corners_odom: (k, 3) of the surface's convex outline. The views share the bearings that the
    outline spans as seen from `camera_odom`; they are ordered from the middle outwards, and each
    looks at the middle of the surface along its bearing.
    """
    centre = corners_odom.mean(axis=0)
    ahead = math.atan2(centre[1] - camera_odom[1], centre[0] - camera_odom[0])
    offsets = corners_odom[:, :2] - camera_odom[:2]
    turned = np.arctan2(offsets[:, 1], offsets[:, 0]) - ahead
    bearings = np.arctan2(np.sin(turned), np.cos(turned))
    low, high = float(bearings.min()), float(bearings.max())
    needed = math.ceil((high - low) / (OVERLAP * camera.horizontal_fov))
    count = max(at_least, needed, 1)
    share = (np.arange(count) + 0.5) / count
    views = [float(low + (high - low) * s) for s in share]
    views.sort(key=lambda bearing: (abs(bearing - (low + high) / 2), bearing))
    return [_along(corners_odom, camera_odom, ahead + bearing) for bearing in views]


def _along(corners: Array, camera: Array, heading: float) -> Array:
    """Middle of the part of the outline that a vertical half-plane from the camera cuts."""
    direction = np.array([math.cos(heading), math.sin(heading)])
    across = np.array([-direction[1], direction[0]])
    relative = corners[:, :2] - camera[:2]
    side, forward = relative @ across, relative @ direction
    hits: list[float] = []
    for here, there in _edges(len(corners)):
        if (side[here] > 0) != (side[there] > 0):
            share = side[here] / (side[here] - side[there])
            hits.append(float(forward[here] + share * (forward[there] - forward[here])))
    distance = sum(hits) / len(hits) if hits else float(forward.mean())
    return np.array([*(camera[:2] + distance * direction), float(corners[:, 2].mean())])


def _edges(count: int) -> Sequence[tuple[int, int]]:
    return [(index, (index + 1) % count) for index in range(count)]

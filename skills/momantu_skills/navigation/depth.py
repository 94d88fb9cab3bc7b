"""What hangs higher than the laser's plane, from a depth picture."""

from __future__ import annotations

import numpy as np

from momantu_bt.frames import FrameBuffer
from momantu_bt.geometry import Array
from momantu_bt.messages import CameraImage, RobotState
from momantu_bt.robot import RobotDescription
from momantu_bt.service import PlanningScene
from momantu_skills.navigation.config import NavigationConfig

STRIDE = 6
"""Every sixth pixel in each direction: 2 cm apart at 2 m for a usual camera."""
TILT_DOUBT = 0.02
"""m per m of distance by which floor may seem raised: camera mounting and depth noise."""
LONGEST_ROBOT = 1.5
"""m from the base's axis within which a point may belong to the robot itself."""


def obstacles_and_floor(
    image: CameraImage,
    frames: FrameBuffer,
    description: RobotDescription,
    state: RobotState,
    scene: PlanningScene,
    config: NavigationConfig,
) -> tuple[Array, Array]:
    """Points (n, 2) in the base's way and points (m, 2) of bare floor, base frame, m.

    The base frame's origin lies on the floor. The robot itself and what it holds are left out.
    """
    points = _points(image)
    points = frames.lookup(description.base_frame, image.frame, image.stamp).apply(points)
    distance = np.hypot(points[:, 0], points[:, 1])
    points, distance = (
        points[distance < config.depth_reach],
        distance[distance < config.depth_reach],
    )
    doubt = TILT_DOUBT * distance
    low, high = config.lowest_obstacle, description.height
    in_way = (points[:, 2] > low + doubt) & (points[:, 2] < high)
    bare = np.abs(points[:, 2]) < 0.5 * low + doubt
    near = in_way & (distance < LONGEST_ROBOT)
    own = np.zeros(len(points), dtype=bool)
    if near.any():
        own[near] = scene.is_robot(points[near], state)
    return points[in_way & ~own, :2], points[bare, :2]


def _points(image: CameraImage) -> Array:
    """Measured pixels as points (n, 3) in the optical frame, m."""
    depth = image.depth[::STRIDE, ::STRIDE].astype(np.float64)
    rows, columns = np.nonzero(depth > 0.0)
    z = depth[rows, columns]
    k = image.intrinsics
    x = (columns * STRIDE - k[0, 2]) / k[0, 0] * z
    y = (rows * STRIDE - k[1, 2]) / k[1, 1] * z
    return np.stack([x, y, z], axis=1)

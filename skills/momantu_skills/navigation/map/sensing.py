"""What laser and depth camera measure of the floor, in the base frame: rays, obstacles, floor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.frames import FrameBuffer
from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import CameraImage, LaserScan, RobotState
from momantu_bt.robot import RobotDescription
from momantu_bt.service import PlanningScene
from momantu_skills.navigation.config import NavigationConfig

SPREAD = 0.12
"""Distance between hits that count as independent, m: more than the noise of one, less than any
wall."""


SPACING = 0.011
"""Angle between the pixels that are used, rad: 2 cm apart at 2 m, every sixth of a usual camera."""
TILT_DOUBT = 0.02
"""Largest apparent height of the floor per m of distance: how far camera and base may be tilted."""
HEIGHT_DOUBT = 0.01
"""Largest apparent height per m of distance of a floor whose tilt was measured: depth noise."""
FLOOR_POINTS = 100
"""Fewest points of the floor that tell its tilt."""
NORMAL_MAD = 1.48
"""Standard deviation of normal noise over the median of its absolute values."""
FLOOR_ROUNDS = 3
"""Rounds of fitting the floor, each without the points that the last one left far off."""
LONGEST_ROBOT = 1.5
"""Distance from the base's axis, m, within which a point may belong to the robot itself."""


@dataclass(frozen=True, slots=True, eq=False)
class Rays:
    """One scan in the base frame, projected onto the floor.

    origin: (2,) where the beams start, m. directions: (n, 2) unit vectors. ranges: (n,) m. hit:
    (n,) bool, beams that hit something within the sensor's range.
    """

    origin: Array
    directions: Array
    ranges: Array
    hit: NDArray[np.bool_]

    @classmethod
    def from_scan(cls, scan: LaserScan, base_from_laser: Transform) -> Rays:
        """Convert the scan of a horizontal laser; it may be mounted upside down."""
        angles = scan.angle_min + scan.angle_increment * np.arange(scan.ranges.size)
        flat = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)
        directions = (flat @ base_from_laser.rotation.T)[:, :2]
        lengths = np.sqrt((directions**2).sum(axis=1, keepdims=True))
        good = (scan.ranges >= scan.range_min) & (scan.ranges < scan.range_max)
        return cls(
            base_from_laser.position[:2].copy(),
            np.ascontiguousarray(directions / lengths),
            np.array(scan.ranges, dtype=np.float64),
            np.asarray(good & np.isfinite(scan.ranges)),
        )

    def points(self) -> Array:
        """Positions of the hits: (k, 2) in the base frame, m."""
        return np.asarray(self.origin + self.directions[self.hit] * self.ranges[self.hit, None])

    def thinned(self, count: int) -> Array:
        """About `count` hits, spread evenly over the surfaces: (k, 2) in the base frame, m.

        One hit per cell of `SPREAD` is taken first. Otherwise a table close to the robot, which
        fills half of the view, would count for more than the wall behind it.
        """
        points = self.points()
        cells = np.floor(points / SPREAD).astype(np.int64)
        _, first = np.unique(cells[:, 0] * 100_003 + cells[:, 1], return_index=True)
        points = points[np.sort(first)]
        step = max(1, len(points) // count)
        return np.ascontiguousarray(points[step // 2 :: step])


def obstacles_and_floor(
    image: CameraImage,
    frames: FrameBuffer,
    description: RobotDescription,
    state: RobotState,
    scene: PlanningScene,
    config: NavigationConfig,
) -> tuple[Array, Array]:
    """Obstacle points (n, 3) and points (m, 2) of free floor, base frame, m.

    z of an obstacle's point is its height above the floor. The base frame's origin lies on the
    floor, nearly: the floor's tilt is measured in the picture. Points on the robot and its held
    object are removed.
    """
    points = _points(image)
    points = frames.lookup(description.base_frame, image.frame, image.stamp).apply(points)
    distance = np.hypot(points[:, 0], points[:, 1])
    points, distance = (
        points[distance < config.depth_reach],
        distance[distance < config.depth_reach],
    )
    low, high = config.lowest_obstacle, description.height
    floor = _floor_heights(points, distance, low)
    doubt = (TILT_DOUBT if floor is None else HEIGHT_DOUBT) * distance
    heights = points[:, 2] if floor is None else points[:, 2] - floor
    in_way = (heights > low + doubt) & (points[:, 2] < high)
    bare = np.abs(heights) < 0.5 * low + doubt
    near = in_way & (distance < LONGEST_ROBOT)
    own = np.zeros(len(points), dtype=bool)
    if near.any():
        own[near] = scene.is_robot(points[near], state)
    met = in_way & ~own
    return np.column_stack([points[met, :2], heights[met]]), points[bare, :2]


def _floor_heights(points: Array, distance: Array, low: float) -> Array | None:
    """Where the floor is below and above the points (n, 3), base frame, m: (n,).

    A plane through the lowest points, by least squares. None if there are too few of them, or if
    the plane is tilted by more than a floor can seem to be: then it is something else.
    """
    most = 0.5 * low + TILT_DOUBT * distance
    chosen = np.abs(points[:, 2]) < most
    flat = np.column_stack([points[:, :2], np.ones(len(points))])
    heights = np.zeros(len(points))
    for _ in range(FLOOR_ROUNDS):
        if np.count_nonzero(chosen) < FLOOR_POINTS:
            return None
        plane = np.linalg.lstsq(flat[chosen], points[chosen, 2], rcond=None)[0]
        heights = flat @ plane
        off = np.abs(points[:, 2] - heights)
        chosen &= off < 3.0 * NORMAL_MAD * np.median(off[chosen]) + 1e-3
    return heights if np.all(np.abs(heights) < most) else None


def _points(image: CameraImage) -> Array:
    """Measured pixels as points (n, 3) in the optical frame, m."""
    k = image.intrinsics
    stride = max(1, round(SPACING * k[0, 0]))
    depth = image.depth[::stride, ::stride].astype(np.float64)
    rows, columns = np.nonzero(depth > 0.0)
    z = depth[rows, columns]
    x = (columns * stride - k[0, 2]) / k[0, 0] * z
    y = (rows * stride - k[1, 2]) / k[1, 1] * z
    return np.stack([x, y, z], axis=1)

"""A flat world for navigation: two rooms, a desk, and a robot whose odometry drifts."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from momantu_skills.manipulation.model.hulls import floor_outline

from momantu_bt.geometry import Pose2D
from momantu_bt.messages import (
    CameraImage,
    LaserScan,
    RobotState,
    frozen,
)
from momantu_bt.robot import RobotDescription
from momantu_bt.service import HeldObject
from momantu_bt.testing import (
    ScriptedRobot,
    ScriptedWorld,
)
from momantu_bt.world import seeded

Box = tuple[float, float, float, float]
"""x from, y from, x to, y to, in the map, m."""


class FlatRobot(ScriptedRobot):
    """Stands truly at `truth`; its odometry starts at 0 and drifts, its laser is noisy.

    boxes: what stands in the world. nearest: least distance of the base's outline to any, m.
    """

    def __init__(
        self,
        truth: Pose2D,
        seed: int = 0,
        drift: float = 0.02,
        description: RobotDescription | None = None,
    ) -> None:
        super().__init__(description)
        self.truth, self.seed, self.drift = truth, seed, drift
        self.boxes: list[Box] = []
        self.nearest = math.inf
        self.last_scan: LaserScan | None = None
        self.mount = self.description.kinematics().base_from_frame(
            self.description.laser()[1].frame, self.joints
        )
        self.readings = {"laser": _scan, "camera": _blind}

    def advance(self, seconds: float) -> None:
        before = self.base
        super().advance(seconds)
        step = before.inverse() @ self.base
        self.truth = self.truth @ Pose2D(
            step.x * (1 + self.drift), step.y, step.yaw * (1 - self.drift)
        )
        corners = np.array(self.description.footprint)
        outline = np.concatenate(
            [a + np.linspace(0, 1, 9)[:, None] * (b - a) for a, b in _pairs(corners)]
        )
        self.nearest = min(self.nearest, float(self.distance(_placed(self.truth, outline)).min()))

    def distance(self, points: np.ndarray) -> np.ndarray:
        """Distance (n,) of points (n, 2) in the map to the nearest box, 0 inside."""
        best = np.full(len(points), 1e9)
        for x0, y0, x1, y1 in self.boxes:
            dx = np.maximum(np.maximum(x0 - points[:, 0], points[:, 0] - x1), 0.0)
            dy = np.maximum(np.maximum(y0 - points[:, 1], points[:, 1] - y1), 0.0)
            best = np.minimum(best, np.hypot(dx, dy))
        return np.asarray(best)


def _pairs(corners: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    return list(zip(corners, np.roll(corners, -1, axis=0), strict=True))


def _placed(pose: Pose2D, points: np.ndarray) -> np.ndarray:
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    return points @ np.array([[c, s], [-s, c]]) + (pose.x, pose.y)


def _scan(robot: ScriptedRobot) -> LaserScan:
    assert isinstance(robot, FlatRobot)
    if robot.last_scan is not None and robot.last_scan.stamp == robot.time:
        return robot.last_scan
    sensor = robot.description.laser()[1]
    angles = np.linspace(sensor.angle_min, sensor.angle_max, sensor.beams)
    flat = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    ways = (flat @ robot.mount.rotation.T)[:, :2]
    c, s = math.cos(robot.truth.yaw), math.sin(robot.truth.yaw)
    start = _placed(robot.truth, robot.mount.position[None, :2])[0]
    ranges = _cast(start, ways @ np.array([[c, s], [-s, c]]), np.array(robot.boxes))
    noise = seeded(robot.seed, "laser", robot.time).normal(0.0, 0.015, len(ranges))
    ranges = np.where(ranges < sensor.range_max, ranges + noise, sensor.range_max)
    robot.last_scan = LaserScan(
        stamp=robot.time,
        frame=sensor.frame,
        angle_min=sensor.angle_min,
        angle_increment=(sensor.angle_max - sensor.angle_min) / (sensor.beams - 1),
        range_min=sensor.range_min,
        range_max=sensor.range_max,
        ranges=frozen(ranges),
    )
    return robot.last_scan


def _cast(start: np.ndarray, ways: np.ndarray, boxes: np.ndarray) -> np.ndarray:
    """Distance (n,) along rays (n, 2) to the first of boxes (k, 4), by slabs."""
    with np.errstate(divide="ignore"):
        low = (boxes[:, None, :2] - start) / ways[None]
        high = (boxes[:, None, 2:] - start) / ways[None]
    enter = np.minimum(low, high).max(axis=2)
    leave = np.maximum(low, high).min(axis=2)
    met = (enter <= leave) & (leave > 0.0)
    return np.where(met, np.maximum(enter, 0.0), 1e9).min(axis=0)


def _blind(robot: ScriptedRobot) -> CameraImage:
    """A camera that measures no depth anywhere."""
    camera = robot.description.camera()[1]
    size = (camera.height, camera.width)
    focus = 0.5 * camera.width / math.tan(0.5 * camera.horizontal_fov)
    k = np.array([[focus, 0, size[1] / 2], [0, focus, size[0] / 2], [0, 0, 1]])
    color, depth = np.zeros((*size, 3), np.uint8), np.zeros(size, np.float32)
    return CameraImage(robot.time, camera.frame, color, depth, k)


class FlatScene:
    """A planning scene whose footprint is the base's, and to which nothing is the robot.

    load: height of the lowest point and corners (n, 2) of something that sticks out, base frame.
    """

    held: HeldObject | None = None
    last_contact = -math.inf

    def __init__(self, outline: Sequence[tuple[float, float]]) -> None:
        self.outline = np.array(outline)
        self.load: tuple[float, np.ndarray] | None = None
        self.low_things = np.empty((0, 2))

    def footprint(self, state: RobotState, below: float = math.inf) -> np.ndarray:
        if self.load is None or self.load[0] >= below:
            return self.outline
        return floor_outline(np.vstack([self.outline, self.load[1]]))

    def is_robot(self, points: np.ndarray, state: RobotState) -> np.ndarray:
        return np.zeros(len(points), dtype=bool)

    def overhang(self, state: RobotState) -> np.ndarray:
        return np.empty((0, 5))

    def solids(self, state: RobotState, hits: np.ndarray, reach: float) -> np.ndarray:
        return np.empty((0, 5))

    def not_free(self, state: RobotState, columns: np.ndarray) -> np.ndarray:
        return columns


def write_map(folder: Path, known: Sequence[Box], span: Box) -> Path:
    """A map_server map of boxes, 0.05 m per pixel, over `span`."""
    columns, rows = round((span[2] - span[0]) / 0.05), round((span[3] - span[1]) / 0.05)
    y, x = np.mgrid[0:rows, 0:columns]
    x, y = span[0] + (x + 0.5) * 0.05, span[1] + (y + 0.5) * 0.05
    pixels = np.full((rows, columns), 254, np.uint8)
    for x0, y0, x1, y1 in known:
        pixels[(x > x0) & (x < x1) & (y > y0) & (y < y1)] = 0
    header = f"P5\n# drawn\n{columns} {rows}\n255\n".encode()
    (folder / "flat.pgm").write_bytes(header + pixels[::-1].tobytes())
    (folder / "flat.yaml").write_text(
        f"image: flat.pgm\nresolution: 0.05\norigin: [{span[0]}, {span[1]}, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    return folder / "flat.yaml"


Flat = Callable[..., ScriptedWorld]
FlatSceneOf = Callable[[ScriptedWorld], FlatScene]

ROOMS: tuple[Box, ...] = (
    (-4.0, -3.0, 6.0, -2.9),
    (-4.0, 3.0, 6.0, 3.1),
    (-4.1, -3.0, -4.0, 3.1),
    (6.0, -3.0, 6.1, 3.1),
    (1.0, -3.0, 1.1, 0.4),
    (1.0, 1.5, 1.1, 3.0),
    (-3.2, -2.9, -2.2, -2.3),
)
"""Two rooms with a doorway 1.1 m wide between them, and a cupboard to tell left from right."""

DESK: Box = (3.6, -0.4, 4.2, 0.8)
"""A solid desk in the second room."""


START = Pose2D(-2.0, 0.0, 0.0)
"""In the first room, looking at the doorway's side."""

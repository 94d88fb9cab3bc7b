"""Checks of sensors: those that see the robot itself, or are tilted."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from momantu_bt.findings import FindingAtKeys
from momantu_bt.formats.problems import Severity
from momantu_bt.geometry import Array, Transform
from momantu_bt.robot import (
    REQUIRED_POSES,
    CameraSensor,
    LaserSensor,
    LidarSensor,
    RobotDescription,
)
from momantu_skills.manipulation.model.hulls import placed
from momantu_skills.robot_setup.check.body import AT_REST, in_poses
from momantu_skills.robot_setup.urdf.body import Body
from momantu_skills.robot_setup.urdf.rays import blocked, planes_of

COLUMNS, ROWS = 48, 36
"""Columns and rows of rays through a camera's picture."""
COVERED, BLIND = 0.2, 0.6
"""Shares of the picture covered by the robot above which a camera gets a warning, or counts as
useless."""
SECTORS = 180
"""Directions of a laser that are checked."""
SHADOW, DARK = 0.1, 0.5
"""Shares of the beams blocked by the robot above which a laser gets a warning, or counts as
useless."""
LEVEL = 0.05
"""Largest tilt of a laser's plane, rad."""
TILTED = 0.5
"""Least cosine between the picture's downward direction and the vertical; less means a wrong
frame."""
LOOKING, FOLDED = "look_around", "home"
"""The poses in which a camera is meant to have a free view, and in which the robot drives."""


def _postures(description: RobotDescription) -> dict[str, dict[str, float]]:
    """The poses that every robot with an arm has; at rest one without named poses."""
    poses = description.named_poses
    return {name: poses[name] for name in REQUIRED_POSES if name in poses} or {AT_REST: {}}


def check_sensors(description: RobotDescription, body: Body) -> Iterator[FindingAtKeys]:
    """All sensors, in every required pose."""
    for name, sensor in description.sensors.items():
        if isinstance(sensor, CameraSensor):
            yield from _camera(description, body, name, sensor)
        elif isinstance(sensor, LaserSensor):
            yield from _level(description, name, sensor.frame)
            yield from _laser(description, body, name, sensor)


def _camera(
    description: RobotDescription, body: Body, name: str, sensor: CameraSensor
) -> Iterator[FindingAtKeys]:
    rays = _pixels(sensor)
    shares = {
        pose: float((_hits(description, body, pose, sensor.frame, rays) < sensor.max_depth).mean())
        for pose in _postures(description)
    }
    covered = [pose for pose, share in shares.items() if share > COVERED]
    if covered:
        most = max(shares[pose] for pose in covered)
        blind, first = shares.get(LOOKING, most) > BLIND, description.camera()[0]
        yield FindingAtKeys(
            Severity.ERROR if blind and name == first else Severity.WARNING,
            "camera-sees-itself",
            f"the robot covers up to {most:.0%} of the picture of {name} in {in_poses(covered)}",
            "turn the camera or move the arm out of the picture in that pose",
            ("named_poses", covered[0]),
        )
    pose = next((n for n in shares if n == LOOKING), next(iter(shares)))
    optical = _frame(description, pose, sensor.frame)
    if optical.rotation[:, 1] @ (0.0, 0.0, -1.0) < TILTED:
        yield FindingAtKeys(
            Severity.WARNING,
            "camera-tilted",
            f"in {in_poses([pose])} the picture of {name} does not stand upright",
            "name an optical frame: z out of the camera, x to the right, y down; nothing is to do "
            "where the camera itself is mounted so",
            ("sensors", name, "frame"),
        )


def _level(description: RobotDescription, name: str, frame: str) -> Iterator[FindingAtKeys]:
    upright = abs(float(_frame(description, FOLDED, frame).rotation[2, 2]))
    if upright < math.cos(LEVEL):
        yield FindingAtKeys(
            Severity.ERROR,
            "laser-tilted",
            f"the plane of {name} is tilted by {math.degrees(math.acos(min(1.0, upright))):.0f} "
            "degrees: the floor plan is seen nowhere",
            "name a frame whose z is vertical",
            ("sensors", name, "frame"),
        )


def _laser(
    description: RobotDescription, body: Body, name: str, sensor: LaserSensor
) -> Iterator[FindingAtKeys]:
    """Beams that the robot stops; of a scan made from a lidar, sectors with no free ring."""
    source = description.sensors.get(sensor.source or "")
    rings = source.elevations if isinstance(source, LidarSensor) else (0.0,)
    frame = source.frame if isinstance(source, LidarSensor) else sensor.frame
    rays = _beams(sensor, rings)
    shares = {
        pose: float(
            np.isfinite(_hits(description, body, pose, frame, rays))
            .reshape(len(rings), SECTORS)
            .all(axis=0)
            .mean()
        )
        for pose in _postures(description)
    }
    stopped = [pose for pose, share in shares.items() if share > SHADOW]
    if stopped:
        most = max(shares.values())
        yield FindingAtKeys(
            Severity.ERROR if most > DARK else Severity.WARNING,
            "laser-sees-itself",
            f"the robot stops up to {most:.0%} of the beams of {name} in {in_poses(stopped)}",
            "move it, narrow its angles, or fold the arm elsewhere",
            ("sensors", name),
        )


def _hits(description: RobotDescription, body: Body, pose: str, frame: str, rays: Array) -> Array:
    """(n,) distance at which rays (n, 3), given in a frame, meet the robot's own hulls."""
    base_from_sensor = _frame(description, pose, frame)
    directions = rays @ base_from_sensor.rotation.T
    origins = np.broadcast_to(base_from_sensor.position, directions.shape)
    poses = body.link_poses(description.named_poses.get(pose, {}), list(body.hulls))
    solids = [planes_of(placed(body.hulls[link], poses[link])) for link in body.hulls]
    return blocked(solids, origins, directions)


def _frame(description: RobotDescription, pose: str, frame: str) -> Transform:
    return description.kinematics().base_from_frame(frame, description.named_poses.get(pose, {}))


def _pixels(sensor: CameraSensor) -> Array:
    """Unit directions (n, 3) through the picture, in the optical frame."""
    half = math.tan(sensor.horizontal_fov / 2)
    x, y = np.meshgrid(np.linspace(-half, half, COLUMNS), np.linspace(-half, half, ROWS))
    rays = np.stack([x, y * sensor.height / sensor.width, np.ones_like(x)], axis=-1).reshape(-1, 3)
    return np.asarray(rays / np.linalg.norm(rays, axis=1, keepdims=True))


def _beams(sensor: LaserSensor, rings: tuple[float, ...]) -> Array:
    """Unit directions (rings * SECTORS, 3), ring by ring; elevations of the rings in rad."""
    sectors = np.linspace(sensor.angle_min, sensor.angle_max, SECTORS)
    around, up = (values.ravel() for values in np.meshgrid(sectors, rings))
    level = np.cos(up)
    return np.stack([level * np.cos(around), level * np.sin(around), np.sin(up)], axis=1)

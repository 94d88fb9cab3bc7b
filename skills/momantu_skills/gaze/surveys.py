"""Viewing a surface completely, with several views."""

from __future__ import annotations

import math
from collections.abc import Generator, Sequence
from typing import Any

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Array
from momantu_bt.robot import CameraSensor, Robot
from momantu_bt.service import PlanningScene, Snapshot
from momantu_bt.skill import Compute, Skill
from momantu_skills.gaze.look_at import look_at
from momantu_skills.perception.camera.snapshot import take

OFF_AXIS = math.radians(12.0)
"""Largest angle of the point to the middle of the picture, rad: still well inside."""
OVERLAP = 0.7
"""Largest distance between neighbouring views, as a share of the field of view."""
SIDESTEP = 0.12
"""Offset of further views of an object, m, so that it is seen by other pixels."""
NEAR, TABLE = 1.0, 0.6
"""Assumed distance and height of the point to look at if nothing is known, m: a table ahead."""
AROUND = tuple(math.radians(angle) for angle in (0.0, 40.0, -40.0, 80.0, -80.0))
"""Bearings of those views, rad: neighbouring views of 60 degrees overlap by a third."""


def glance(
    skill: Skill, robot: Robot, scene: PlanningScene, point_odom: Array
) -> Generator[str | Compute, Any, Snapshot | None]:
    """Look at a point (3,) in odom and take a picture; None if the camera cannot look at it.

    A fixed camera looks at all that is in its picture. The planning scene gets the picture too: the
    hand may hide some of its contents later.
    """
    try:
        yield from look_at(skill, robot, point_odom, within=_off_axis(robot))
    except Failure as failure:
        if failure.code != "OUT_OF_VIEW":
            raise
        return None
    snapshot = take(robot, skill.frames)
    scene.observe(snapshot)
    return snapshot


def _off_axis(robot: Robot) -> float:
    """Largest angle of a point to the middle of the picture, rad."""
    sensor = robot.description.camera()[1]
    if sensor.carrier is not None:
        return OFF_AXIS
    across = math.tan(sensor.horizontal_fov / 2)
    return math.atan(across * min(1.0, sensor.height / sensor.width))


def looks_over(skill: Skill, robot: Robot, corners: Array, at_least: int) -> list[Array]:
    """Points (3,) in odom to look at so that the whole surface with these corners (k, 3) is seen.

    They are computed for the camera's current position, or for one above the base if an arm will
    move the camera.
    """
    sensor = robot.description.camera()[1]
    moved = robot.description.eye_in_hand
    viewpoint = robot.description.base_frame if moved else sensor.frame
    return sweep(corners, skill.frames.lookup(ODOM, viewpoint).position, sensor, at_least)


def around(skill: Skill, robot: Robot) -> list[Array]:
    """Points (3,) in odom to look at if nothing is known: ahead, then to both sides.

    Of a fixed camera the one that it looks at.
    """
    camera = robot.description.camera()[1]
    if camera.carrier is None:
        return [skill.frames.lookup(ODOM, camera.frame).apply((0.0, 0.0, NEAR))]
    odom_from_base = skill.frames.lookup(ODOM, robot.description.base_frame)
    points = []
    for bearing in AROUND:
        ahead = (NEAR * math.cos(bearing), NEAR * math.sin(bearing), TABLE)
        points.append(odom_from_base.apply(ahead))
    return points


def beside(thing: Array, camera: Array, count: int) -> Array:
    """The point (3,) to look at in the `count`-th further view of an object at (3,)."""
    if count == 1:
        return thing
    away = thing[:2] - camera[:2]
    across = np.array([-away[1], away[0]]) / max(float(np.hypot(*away)), 1e-9)
    side = SIDESTEP * (1.0 if count % 2 == 0 else -1.0)
    return np.array([*(thing[:2] + side * across), thing[2]])


def sweep(
    corners_odom: Array, camera_odom: Array, camera: CameraSensor, at_least: int
) -> list[Array]:
    """Points (3,) to look at, one after the other, so that the whole surface is seen.

    corners_odom: (k, 3) of the surface's convex outline. The bearings of the views are spread
    evenly over the outline as seen from `camera_odom`, from the middle outwards. Each view looks at
    the middle of the surface along its bearing.
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

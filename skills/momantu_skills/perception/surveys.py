"""Looking over a surface: several views of one region."""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import dataclass
from typing import Any

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Array
from momantu_bt.robot import Robot
from momantu_bt.service import PlanningScene
from momantu_bt.skill import Compute, Skill
from momantu_skills.perception.looking import look_at
from momantu_skills.perception.regions import Region, disc, grown
from momantu_skills.perception.views import Snapshot, sweep, take

BESIDE = 0.20
"""m by which a surface may lie beside where it is believed: 0.10 m of its own and localization."""
HEIGHT_ERROR = 0.12
"""m by which it may be higher or lower: 0.03 m of its own, the camera's mounting, and a person who
measured it badly. The largest level surface in between is it."""
HEADROOM = 0.55
"""m above a surface within which things stand on it."""
OFF_AXIS = math.radians(12.0)
"""How far from the middle of the picture a looked-at point may lie: it is still well inside."""
SIDESTEP = 0.12
"""m beside a thing where further looks at it go, so that it falls on other pixels."""
NEAR, TABLE = 1.0, 0.6
"""m; distance and height of what is looked at where nothing is known: a table ahead."""
AROUND = tuple(math.radians(angle) for angle in (0.0, 40.0, -40.0, 80.0, -80.0))
"""rad; bearings of those looks: neighbouring views of 60 degrees overlap by a third."""
WIDE = 0.30
"""m to each side of a place that the looks at it are spread over."""
PATCH = 0.60
"""m around a place within which a surface and what stands there matter to a hand."""
PLACE_ERROR = 0.03
"""m by which a place that was measured may be higher or lower than its surface."""


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceRegion(Region):
    """Where a surface and what stands on it are looked for.

    support_heights: (lowest, highest) z of the surface itself in odom, m.
    """

    support_heights: tuple[float, float]


def surface_region(corners: Array) -> SurfaceRegion:
    """Around a surface whose corners (4, 3) in odom are roughly known."""
    height = float(corners[:, 2].mean())
    low, high = height - HEIGHT_ERROR, height + HEIGHT_ERROR
    return SurfaceRegion(grown(corners[:, :2], BESIDE), low, high + HEADROOM, (low, high))


def glance(
    skill: Skill, robot: Robot, scene: PlanningScene, point_odom: Array
) -> Generator[str | Compute, Any, Snapshot | None]:
    """Look at a point (3,) in odom and take a picture; None when it cannot be looked at.

    The planning scene sees the picture too: from here things may be in view that the hand hides
    later.
    """
    try:
        yield from look_at(skill, robot, point_odom, within=OFF_AXIS)
    except Failure as failure:
        if failure.code != "OUT_OF_VIEW":
            raise
        return None
    scene.observe(robot)
    return take(skill, robot)


def looks_over(skill: Skill, robot: Robot, corners: Array, at_least: int) -> list[Array]:
    """Points (3,) in odom to look at so that a surface of these corners (k, 3) is seen whole.

    From where the camera is, or, where an arm will carry it elsewhere, from above the base.
    """
    sensor = robot.description.camera()[1]
    moved = robot.description.eye_in_hand
    viewpoint = robot.description.base_frame if moved else sensor.frame
    return sweep(corners, skill.frames.lookup(ODOM, viewpoint).position, sensor, at_least)


def around(skill: Skill, robot: Robot) -> list[Array]:
    """Points (3,) in odom to look at where nothing is known: ahead, then to both sides."""
    odom_from_base = skill.frames.lookup(ODOM, robot.description.base_frame)
    points = []
    for bearing in AROUND:
        ahead = (NEAR * math.cos(bearing), NEAR * math.sin(bearing), TABLE)
        points.append(odom_from_base.apply(ahead))
    return points


def place_region(near: Array) -> tuple[Array, SurfaceRegion]:
    """What to look over (4, 3) and where points count, around a measured place (3,) in odom."""
    square = WIDE * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    corners = np.column_stack([near[:2] + square, np.full(4, near[2])])
    low, high = float(near[2]) - PLACE_ERROR, float(near[2]) + PLACE_ERROR
    outline = disc(near[:2], PATCH)
    return corners, SurfaceRegion(outline, low, high + HEADROOM, (low, high))


def beside(thing: Array, camera: Array, count: int) -> Array:
    """Where to look (3,) for the `count`-th further view of a thing at (3,): at it, then beside."""
    if count == 1:
        return thing
    away = thing[:2] - camera[:2]
    across = np.array([-away[1], away[0]]) / max(float(np.hypot(*away)), 1e-9)
    side = SIDESTEP * (1.0 if count % 2 == 0 else -1.0)
    return np.array([*(thing[:2] + side * across), thing[2]])

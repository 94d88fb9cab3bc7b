"""A measured surface: its plane, the objects on it, and its free spots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from momantu_bt.detector import View
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Array, Pose, Transform, quaternion_from_axis_angle
from momantu_bt.messages import SupportPlane
from momantu_skills.perception.geometry.regions import SurfaceRegion
from momantu_skills.perception.surface.planes import Support, measure_support
from momantu_skills.perception.surface.segment import SegmentConfig, Thing, headroom, things_on
from momantu_skills.perception.surface.spots import SpotConfig, free_spots, survey_ground


@dataclass(frozen=True, slots=True)
class Surroundings:
    """plane: the surface and its obstacles. spots: free spots, best first, in odom."""

    plane: SupportPlane
    spots: tuple[Pose, ...]


def surroundings(
    views: Sequence[View],
    region: SurfaceRegion,
    near: Array,
    odom_from_base: Transform,
    radius: float,
    config: SpotConfig | None = None,
) -> Surroundings | None:
    """The surface around `near` (3,) in odom, and spots on it for a base of `radius` m.

    None if no view shows a level surface at that height.
    """
    config, segments = config or SpotConfig(), SegmentConfig()
    support = measure_support(views, *region.support_heights)
    if support is None:
        return None
    things = things_on(support, segments)
    ground = survey_ground(support, segments.floor, headroom(support, segments), config)
    robot = odom_from_base.position[:2]
    places = free_spots(ground, support.outline, near[:2], robot, radius, config)
    turn = quaternion_from_axis_angle((0.0, 0.0, 1.0), odom_from_base.yaw)
    spots = tuple(
        Pose(Transform((x, y, support.height), turn), ODOM, support.stamp) for x, y in places
    )
    return Surroundings(_plane(support, things, near), spots)


def _plane(support: Support, things: Sequence[Thing], near: Array) -> SupportPlane:
    origin = np.array([near[0], near[1], support.height])
    outline = tuple((float(x), float(y)) for x, y in support.outline - near[:2])
    obstacles = tuple(_obstacle(thing, near) for thing in things)
    return SupportPlane(Pose(Transform(origin), ODOM, support.stamp), outline, obstacles)


def _obstacle(thing: Thing, near: Array) -> tuple[float, float, float, float]:
    """x, y, radius of the circle around an object, in the plane's frame, and its height, m."""
    flat = thing.points[:, :2]
    centre = (flat.min(axis=0) + flat.max(axis=0)) / 2
    radius = float(np.percentile(np.linalg.norm(flat - centre, axis=1), 99.0))
    x, y = centre - near[:2]
    return float(x), float(y), radius, thing.height

"""The floor under a robot, in one straightened turn."""

from __future__ import annotations

import math

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.mapping.three_d.config import CloudConfig

ROUNDS = 4
"""Rounds of fitting, each without what the last one left far off."""
OFF = 0.03
"""Distance from the plane beyond which a point is not the floor's, m: three sigma of ranges."""
STEEPEST = math.radians(6.0)
"""Tilt of the floor in base beyond which it is none, rad."""
NARROWEST = 0.3
"""Least spread of the points in every direction, m: a single ring ahead tells no tilt."""


def floor_plane(points: Array, config: CloudConfig) -> Array | None:
    """The floor (4,) in base from points (n, 3): normal, upwards, and -distance, m; None: unseen.

    For points p on it, normal . p + last = 0.
    """
    near = np.hypot(points[:, 0], points[:, 1]) < config.floor_reach
    found = points[near]
    slope_x = slope_y = height = 0.0
    for number in range(ROUNDS):
        away = found[:, 2] - (height + slope_x * found[:, 0] + slope_y * found[:, 1])
        kept = found[np.abs(away) < (OFF if number else config.floor_height)]
        if len(kept) < config.floor_points:
            return None
        middle = kept[:, :2].mean(axis=0)
        spread = np.linalg.eigvalsh(np.cov((kept[:, :2] - middle).T))[0]
        if spread < NARROWEST**2:
            return None
        terms = np.column_stack([kept[:, :2], np.ones(len(kept))])
        (slope_x, slope_y, height), *_ = np.linalg.lstsq(terms, kept[:, 2], rcond=None)
    if math.hypot(slope_x, slope_y) > math.tan(STEEPEST):
        return None
    plane = np.array([-slope_x, -slope_y, 1.0, -height])
    return np.asarray(plane / math.sqrt(slope_x**2 + slope_y**2 + 1.0))

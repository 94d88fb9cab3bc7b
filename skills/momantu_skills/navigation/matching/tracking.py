"""Where a scan was taken, from odometry and the submap that grows."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array, Pose2D
from momantu_skills.navigation.matching import likelihood, lines
from momantu_skills.navigation.matching.config import MatchingConfig
from momantu_skills.navigation.matching.poses import as_array, as_pose
from momantu_skills.navigation.matching.scan import ScanPoints
from momantu_skills.navigation.matching.submap import Growing

FEWEST = 25
"""Fewest points on lines for a match to count."""
LOST = np.diag([0.3**2, 0.3**2, 0.15**2])
"""Covariance (m, m, rad) of a scan that matches nothing."""
FLOOR = np.diag([0.01**2, 0.01**2, 0.003**2])
"""Least covariance of a match: what cells and timing leave."""
_WEAK = np.eye(3) * 1e-2
"""Information that keeps a corridor's covariance finite."""
_TURN_STEP = 0.012
"""Step of yaw, rad: 10 cm at the farthest points that matter."""
_GATE = 0.12
"""Distance of points to their lines at the end, m."""
_MOST_DOUBT = 1000.0


@dataclass(frozen=True, slots=True, eq=False)
class Tracked:
    """A scan's place. pose: `submap_from_base`; covariance: (3, 3) in base; score: 0..1."""

    pose: Pose2D
    covariance: Array
    score: float


def odometry_deviation(motion: Pose2D, config: MatchingConfig) -> Array:
    """Standard deviations (m, rad) of a step that odometry tells."""
    way, turn = math.hypot(motion.x, motion.y), abs(motion.yaw)
    return np.array(
        [
            config.drift + config.drift_per_metre * way,
            config.turn_drift
            + config.turn_drift_per_metre * way
            + config.turn_drift_per_radian * turn,
        ]
    )


def track(
    submap: Growing, last: Pose2D, motion: Pose2D, scan: ScanPoints, config: MatchingConfig
) -> Tracked:
    """Match a scan. last: `submap_from_base` of the scan before; motion: odometry since then."""
    expected = as_array(last @ motion)
    deviation = odometry_deviation(motion, config)
    if len(scan.points) < FEWEST:
        return Tracked(as_pose(expected), LOST, 0.0)
    score, start = likelihood.best_pose(
        submap.grid,
        submap.bound,
        submap.corner,
        config.resolution,
        scan.points,
        expected,
        np.array([0.15, 0.06]) + 2.5 * deviation,
        _TURN_STEP,
        deviation,
    )
    lacking = max(1.0, config.good_score / max(score, 0.05))
    doubt = min(_MOST_DOUBT, lacking**6)
    pose, information, _, count = lines.lay_on(
        submap.index,
        submap.points,
        submap.normals,
        submap.corner,
        config.resolution,
        scan.points,
        scan.normals,
        start,
        expected,
        deviation,
        doubt,
        _GATE,
    )
    if count < FEWEST:
        return Tracked(as_pose(start), LOST, score)
    turn = np.eye(3)
    c, s = math.cos(pose[2]), math.sin(pose[2])
    turn[:2, :2] = [[c, s], [-s, c]]
    covariance = turn @ np.linalg.inv(information + _WEAK) @ turn.T + FLOOR
    return Tracked(as_pose(pose), covariance, score)

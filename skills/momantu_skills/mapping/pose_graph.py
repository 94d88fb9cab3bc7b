"""The poses of scans and submaps that fit odometry, matches and loops best: gtsam's work."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from momantu_bt.geometry import Array, Pose2D
from momantu_bt.lazy import lazily
from momantu_skills.mapping.loops import Loop
from momantu_skills.navigation.matching.config import MatchingConfig
from momantu_skills.navigation.matching.tracking import odometry_deviation

with lazily():
    import gtsam

FIXED = np.array([1e-3, 1e-3, 1e-4])
"""Standard deviations (m, m, rad) of the first pose."""
LOOP = np.array([0.05, 0.05, 0.01])
"""The same of a loop."""
TOLERANCES = (32.0, 8.0, 2.0)
"""Deviations beyond which a loop loses its influence, one optimisation after the other: at first
many right loops move what a wrong match holds, then the few wrong loops let go."""
SLACK = 3.0
"""How many times larger than its deviations odometry's error may be in the graph: it slips."""


@dataclass(frozen=True, slots=True, eq=False)
class Match:
    """`submap_from_base` of a scan, with its covariance (3, 3) in base.

    entered: the scan is a part of the submap.
    """

    submap: int
    scan: int
    pose: Pose2D
    covariance: Array
    entered: bool = True


def optimise(
    scans: Sequence[Pose2D],
    submaps: Sequence[Pose2D],
    motions: Sequence[Pose2D | None],
    matches: Sequence[Match],
    loops: Sequence[Loop],
    config: MatchingConfig,
) -> tuple[list[Pose2D], list[Pose2D]]:
    """`map_from_base` of all scans and `map_from_submap` of all submaps, from first estimates.

    motions: by odometry from each scan to the next, None where a session begins. Matches are
    weighted by Huber's function, loops and odometry by Cauchy's: a wrong one loses its influence.
    """
    values = gtsam.Values()
    for i, pose in enumerate(scans):
        values.insert(_scan(i), _of(pose))
    for i, pose in enumerate(submaps):
        values.insert(_submap(i), _of(pose))
    rigid = _rigid(scans[0], motions, matches, config)
    for tolerance in TOLERANCES if loops else TOLERANCES[-1:]:
        graph = gtsam.NonlinearFactorGraph(rigid)
        for loop in loops:
            noise = _robust(_cauchy(tolerance), _independent(LOOP))
            keys = _submap(loop.older), _submap(loop.newer)
            graph.add(gtsam.BetweenFactorPose2(*keys, _of(loop.pose), noise))
        values = gtsam.LevenbergMarquardtOptimizer(graph, values).optimize()
    return (
        [_read(values.atPose2(_scan(i))) for i in range(len(scans))],
        [_read(values.atPose2(_submap(i))) for i in range(len(submaps))],
    )


def _rigid(
    first: Pose2D,
    motions: Sequence[Pose2D | None],
    matches: Sequence[Match],
    config: MatchingConfig,
) -> Any:
    """What is known without loops."""
    graph = gtsam.NonlinearFactorGraph()
    graph.add(gtsam.PriorFactorPose2(_scan(0), _of(first), _independent(FIXED)))
    huber = gtsam.noiseModel.mEstimator.Huber.Create(2.0)
    for match in matches:
        noise = _robust(huber, gtsam.noiseModel.Gaussian.Covariance(match.covariance))
        keys = _submap(match.submap), _scan(match.scan)
        graph.add(gtsam.BetweenFactorPose2(*keys, _of(match.pose), noise))
    for i, motion in enumerate(motions):
        if motion is None:
            continue
        far, turn = odometry_deviation(motion, config) * SLACK
        noise = _robust(_cauchy(1.0), _independent(np.array([far, far, turn])))
        graph.add(gtsam.BetweenFactorPose2(_scan(i), _scan(i + 1), _of(motion), noise))
    return graph


def _cauchy(tolerance: float) -> Any:
    return gtsam.noiseModel.mEstimator.Cauchy.Create(tolerance)


def _scan(i: int) -> int:
    return int(gtsam.symbol("x", i))


def _submap(i: int) -> int:
    return int(gtsam.symbol("s", i))


def _of(pose: Pose2D) -> Any:
    return gtsam.Pose2(pose.x, pose.y, pose.yaw)


def _read(pose: Any) -> Pose2D:
    return Pose2D(float(pose.x()), float(pose.y()), float(pose.theta()))


def _independent(deviations: Array) -> Any:
    return gtsam.noiseModel.Diagonal.Sigmas(deviations)


def _robust(function: Any, noise: Any) -> Any:
    return gtsam.noiseModel.Robust.Create(function, noise)

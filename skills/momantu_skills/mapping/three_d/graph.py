"""The poses of kept turns that fit matches, loops, floor and gravity best: gtsam's work."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.lazy import lazily

with lazily():
    import gtsam

FIXED = np.array([2e-2, 2e-2, 1e-5, 1e-5, 1e-5, 2e-2])
"""Standard deviations (rad, rad, rad, m, m, m) of the first pose: the floor tells tilt and height.
"""
MATCHED = np.array([2e-3, 2e-3, 2e-3, 1e-2, 1e-2, 1e-2])
"""The same of a match with the turns before."""
RECKONED = np.array([1e-2, 1e-2, 1e-2, 5e-2, 5e-2, 5e-2])
"""The same of a step that only IMU and wheels tell."""
CLOSED = np.array([3e-3, 3e-3, 3e-3, 1e-2, 1e-2, 1e-2])
"""The same of a loop."""
FREE = 1e3
"""The same of what nothing tells."""
FLOOR = np.array([4e-3, 4e-3, FREE, FREE, FREE, 6e-3])
"""The same of the pose above a level floor, which tells its tilt and height alone."""
UP = np.array([2e-2, 2e-2])
"""The same of the specific force's direction, rad: twice its bias."""
TOLERANCES = (32.0, 8.0, 2.0)
"""Deviations beyond which a loop loses its influence, one optimisation after the other: at first
many right loops move what a wrong match holds, then the few wrong loops let go."""
LET_GO = 2.0
"""Deviations beyond which floor and gravity lose their influence: on a ramp or a bump."""


@dataclass(frozen=True, slots=True, eq=False)
class Edge:
    """`first_from_second` of two kept turns, by their numbers; sigmas (6,): rad, then m."""

    first: int
    second: int
    pose: Transform
    sigmas: Array


@dataclass(frozen=True, slots=True, eq=False)
class Level:
    """What a kept turn knows of the vertical: the floor (4,) and the way up (3,), in base."""

    floor: Array | None
    up: Array | None


def optimise(
    poses: Sequence[Transform],
    steps: Sequence[Edge],
    loops: Sequence[Edge],
    levels: Sequence[Level],
) -> list[Transform]:
    """`map_from_base` of all kept turns, from first estimates; one floor is under all.

    Steps are weighted by Huber's function, all others by Cauchy's: a wrong one loses its influence.
    """
    values = gtsam.Values()
    for number, pose in enumerate(poses):
        values.insert(_key(number), _of(pose))
    still = _still(poses, steps, levels)
    for tolerance in TOLERANCES if loops else TOLERANCES[-1:]:
        graph = gtsam.NonlinearFactorGraph(still)
        for loop in loops:
            graph.add(_between(loop, _cauchy(tolerance)))
        values = gtsam.LevenbergMarquardtOptimizer(graph, values).optimize()
    return [_read(values.atPose3(_key(number))) for number in range(len(poses))]


def _still(poses: Sequence[Transform], steps: Sequence[Edge], levels: Sequence[Level]) -> Any:
    """What is known without loops."""
    graph = gtsam.NonlinearFactorGraph()
    graph.add(gtsam.PriorFactorPose3(_key(0), _of(poses[0]), _independent(FIXED)))
    huber = gtsam.noiseModel.mEstimator.Huber.Create(2.0)
    for step in steps:
        graph.add(_between(step, huber))
    for number, level in enumerate(levels):
        if level.floor is not None:
            noise = _robust(_cauchy(LET_GO), _independent(FLOOR))
            standing = _of(above_floor(level.floor, poses[number]))
            graph.add(gtsam.PriorFactorPose3(_key(number), standing, noise))
        if level.up is not None:
            noise = _robust(_cauchy(LET_GO), _independent(UP))
            upwards = gtsam.Unit3(np.array([0.0, 0.0, 1.0]))
            felt = gtsam.Unit3(level.up)
            graph.add(gtsam.AttitudeFactorPose3(_key(number), upwards, noise, felt))
    return graph


def above_floor(floor: Array, about: Transform) -> Transform:
    """The pose from which a level floor at z = 0 looks like `floor` (4,); x, y, yaw of `about`."""
    x, y, z, height = floor
    roll, pitch = math.atan2(y, z), math.atan2(-x, math.hypot(y, z))
    return Transform.from_rpy(
        (float(about.position[0]), float(about.position[1]), float(height)),
        (roll, pitch, about.yaw),
    )


def _between(edge: Edge, function: Any) -> Any:
    noise = _robust(function, _independent(edge.sigmas))
    return gtsam.BetweenFactorPose3(_key(edge.first), _key(edge.second), _of(edge.pose), noise)


def _cauchy(tolerance: float) -> Any:
    return gtsam.noiseModel.mEstimator.Cauchy.Create(tolerance)


def _independent(deviations: Array) -> Any:
    return gtsam.noiseModel.Diagonal.Sigmas(deviations)


def _robust(function: Any, noise: Any) -> Any:
    return gtsam.noiseModel.Robust.Create(function, noise)


def _key(number: int) -> int:
    return int(gtsam.symbol("x", number))


def _of(pose: Transform) -> Any:
    return gtsam.Pose3(pose.matrix)


def _read(pose: Any) -> Transform:
    return Transform.from_matrix(pose.matrix())

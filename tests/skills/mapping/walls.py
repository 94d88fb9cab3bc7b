"""A building of walls that a laser sees, for tests of mapping."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from momantu_skills.mapping.logs.log import LoggedScan
from momantu_skills.navigation.map.sensing import Rays

from momantu_bt.geometry import Array, Pose2D

Wall = tuple[float, float, float, float]
ANGLES = np.radians(np.arange(-110.0, 110.5, 1.0))
REACH = 12.0
NOISE = 0.01


def box(x: float, y: float, width: float, depth: float) -> list[Wall]:
    """The four walls of a rectangle from its lower left corner."""
    return [
        (x, y, x + width, y),
        (x + width, y, x + width, y + depth),
        (x + width, y + depth, x, y + depth),
        (x, y + depth, x, y),
    ]


RING = [
    *box(0, 0, 16, 12),
    *box(3, 3, 10, 6),
    (0.0, 5.0, 1.2, 5.0),
    *box(7, 0.4, 0.7, 0.5),
    *box(14.8, 4, 0.6, 0.9),
    *box(5, 11, 1.1, 0.5),
    (16.0, 9.0, 14.9, 9.0),
    (9.5, 12.0, 9.5, 11.0),
    *box(0.4, 8, 0.4, 0.7),
]
"""A corridor around a block, with things in it so that it looks different everywhere."""
ROUND = [(1.5, 1.5), (14.0, 1.5), (14.0, 10.4), (1.5, 10.4), (1.5, 1.5), (14.0, 1.5)]


def seen(walls: Sequence[Wall], pose: Pose2D, noise: np.random.Generator) -> Rays:
    """A scan at `map_from_base`; the laser is 0.2 m ahead of the base."""
    mount = Pose2D(0.2, 0.0)
    at = pose @ mount
    directions = np.column_stack([np.cos(ANGLES + at.yaw), np.sin(ANGLES + at.yaw)])
    ranges = np.full(len(ANGLES), np.inf)
    for x0, y0, x1, y1 in walls:
        ex, ey = x1 - x0, y1 - y0
        cross = directions[:, 0] * ey - directions[:, 1] * ex
        with np.errstate(divide="ignore", invalid="ignore"):
            along = ((x0 - at.x) * ey - (y0 - at.y) * ex) / cross
            share = ((x0 - at.x) * directions[:, 1] - (y0 - at.y) * directions[:, 0]) / cross
        there = (along > 0) & (share >= 0) & (share <= 1)
        ranges = np.where(there & (along < ranges), along, ranges)
    hit = ranges < REACH
    ranges = np.where(hit, ranges + noise.normal(0.0, NOISE, len(ranges)), 0.0)
    own = np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])
    return Rays(np.array([mount.x, mount.y]), own, ranges, hit)


def driven(corners: Sequence[tuple[float, float]], step: float) -> list[Pose2D]:
    """Poses on straight lines between corners, turning on the spot at each."""
    poses: list[Pose2D] = []
    for (x0, y0), (x1, y1) in itertools.pairwise(corners):
        yaw, way = math.atan2(y1 - y0, x1 - x0), math.hypot(x1 - x0, y1 - y0)
        if poses:
            turn = math.remainder(yaw - poses[-1].yaw, math.tau)
            poses += [Pose2D(x0, y0, poses[-1].yaw + turn * k / 4) for k in (1, 2, 3)]
        count = math.ceil(way / step)
        poses += [
            Pose2D(x0 + (x1 - x0) * k / count, y0 + (y1 - y0) * k / count, yaw)
            for k in range(count)
        ]
    return poses


def logged(poses: Sequence[Pose2D], seed: int, walls: Sequence[Wall] = RING) -> list[LoggedScan]:
    """What a robot that drives along poses records: its odometry drifts."""
    noise = np.random.default_rng(seed)
    scale, bend = 1 + noise.normal(0, 0.02), noise.normal(0, 0.01)
    odom, last, scans = Pose2D(0.0, 0.0), poses[0], []
    for n, pose in enumerate(poses):
        step = last.inverse() @ pose
        way = math.hypot(step.x, step.y)
        turn = step.yaw + bend * way + noise.normal(0, 0.01 * way + 0.02 * abs(step.yaw))
        odom = odom @ Pose2D(step.x * scale + noise.normal(0, 0.02 * way), step.y, turn)
        last = pose
        scans.append(LoggedScan(0.5 * n, odom, seen(walls, pose, noise)))
    return scans


def error(found: Sequence[Pose2D], true: Sequence[Pose2D]) -> float:
    """Root mean square distance of two trajectories after they are laid on each other, m."""
    a, b = (_centred(poses) for poses in (found, true))
    angle = math.atan2(float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()), float((a * b).sum()))
    c, s = math.cos(angle), math.sin(angle)
    return float(np.sqrt((((a @ np.array([[c, s], [-s, c]])) - b) ** 2).sum(axis=1).mean()))


def _centred(poses: Sequence[Pose2D]) -> Array:
    places = np.array([(pose.x, pose.y) for pose in poses])
    return np.asarray(places - places.mean(axis=0))

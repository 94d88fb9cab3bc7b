"""Halls of boxes in which a lidar turns while its base drives, for tests of mapping in 3D."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_bt.messages import ImuReading, PointCloud, frozen
from momantu_bt.motion import Motion

Box = tuple[float, float, float, float, float, float]
"""x, y, z from, then x, y, z to, in the map, m."""

MOUNT = Transform((0.1, 0.0, 0.4))
"""base_from_lidar; the IMU sits in the base's origin."""
RINGS = np.radians(np.arange(-15.0, 16.0, 2.0))
COLUMNS = 300
TURN, SAMPLE = 0.1, 0.01
NOISE = 0.01
GRAVITY = np.array([0.0, 0.0, 9.81])


def walls(x: float, y: float, width: float, depth: float, height: float = 2.5) -> list[Box]:
    """Four walls, 10 cm thick, around a rectangle on the floor."""
    return [
        (x - 0.1, y - 0.1, 0.0, x + width + 0.1, y, height),
        (x - 0.1, y + depth, 0.0, x + width + 0.1, y + depth + 0.1, height),
        (x - 0.1, y, 0.0, x, y + depth, height),
        (x + width, y, 0.0, x + width + 0.1, y + depth, height),
    ]


RING: list[Box] = [
    *walls(0, 0, 14, 10),
    (3.0, 3.0, 0.0, 11.0, 7.0, 2.5),
    (6.0, 0.0, 0.0, 6.6, 0.5, 1.0),
    (13.3, 4.0, 0.0, 14.0, 4.8, 1.5),
    (5.0, 9.2, 0.0, 5.4, 10.0, 2.0),
    (9.0, 9.6, 0.0, 10.0, 10.0, 0.6),
    (0.0, 6.0, 0.0, 0.5, 7.5, 1.2),
    (0.0, 2.2, 0.0, 0.9, 2.4, 2.5),
]
"""A corridor around a block, with things along its walls."""
ROUND = [(1.5, 1.5), (12.5, 1.5), (12.5, 8.5), (1.5, 8.5), (1.5, 1.5), (5.0, 1.5)]
"""Once around it, and on over what was seen before."""


def cast(origins: Array, directions: Array, boxes: list[Box]) -> Array:
    """Distances (n,) along rays (n, 3) to the first of boxes or the floor; infinite: none."""
    best = np.where(directions[:, 2] < 0, -origins[:, 2] / np.minimum(directions[:, 2], -1e-9), 1e9)
    with np.errstate(divide="ignore", invalid="ignore"):
        for box in np.array(boxes):
            low, high = (box[:3] - origins) / directions, (box[3:] - origins) / directions
            enter = np.minimum(low, high).max(axis=1)
            leave = np.maximum(low, high).min(axis=1)
            best = np.where((enter <= leave) & (enter > 0.0), np.minimum(best, enter), best)
    return np.where(best < 60.0, best, np.inf)


@dataclass(frozen=True)
class Moment:
    """What sensors tell at the end of a turn. truth: map_from_base; odometry drifts."""

    stamp: float
    truth: Transform
    odometry: list[tuple[float, Transform, ImuReading]]
    turn: PointCloud


def driven(
    corners: list[tuple[float, float]], speed: float = 0.8, turning: float = 1.0
) -> list[Pose2D]:
    """Poses every SAMPLE seconds: straight along a way, turning in place at its corners."""
    poses = [Pose2D(*corners[0], _towards(corners[0], corners[1]))] * 100
    for begin, end in itertools.pairwise(corners):
        heading, now = _towards(begin, end), poses[-1].yaw
        off = math.remainder(heading - now, 2 * math.pi)
        steps = math.ceil(abs(off) / (turning * SAMPLE))
        poses += [Pose2D(*begin, now + off * (i + 1) / steps) for i in range(steps)]
        way = math.dist(begin, end)
        steps = math.ceil(way / (speed * SAMPLE))
        shares = [(i + 1) / steps for i in range(steps)]
        poses += [
            Pose2D(begin[0] + s * (end[0] - begin[0]), begin[1] + s * (end[1] - begin[1]), heading)
            for s in shares
        ]
    return poses


def _towards(begin: tuple[float, float], end: tuple[float, float]) -> float:
    return math.atan2(end[1] - begin[1], end[0] - begin[0])


def turn_of(motion: Motion, stamp: float, boxes: list[Box], seed: int, noise: float) -> PointCloud:
    """The turn that ends at `stamp` on a lidar whose base moves so in the map."""
    azimuths = np.arange(COLUMNS) * (2 * np.pi / COLUMNS)
    turns, rises = (each.ravel() for each in np.meshgrid(azimuths, RINGS, indexing="ij"))
    flat = np.cos(rises)
    beams = np.column_stack([flat * np.cos(turns), flat * np.sin(turns), np.sin(rises)])
    times = np.repeat((np.arange(COLUMNS) + 1 - COLUMNS) * (TURN / COLUMNS), len(RINGS))
    rotations, places = motion.at(stamp + times)
    origins = places + rotations @ MOUNT.position
    ranges = cast(origins, np.einsum("nij,nj->ni", rotations, beams), boxes)
    ranges = ranges + noise * np.random.default_rng(seed).standard_normal(len(ranges))
    hit = np.isfinite(ranges)
    points = (beams[hit] * ranges[hit, None]).astype(np.float32)
    return PointCloud(stamp, "lidar", frozen(points), frozen(times[hit].astype(np.float32)))


def moments(
    poses: list[Pose2D],
    boxes: list[Box],
    *,
    seed: int = 0,
    drift: float = 0.02,
    noise: float = NOISE,
    bias: float = 0.003,
) -> Iterator[Moment]:
    """What the sensors tell along a way. drift: share by which the wheels count too little."""
    each = round(TURN / SAMPLE)
    motion = Motion.of([i * SAMPLE for i in range(len(poses))], [p.transform() for p in poses])
    wheels = Pose2D(0.0, 0.0, 0.0)
    told = [(0.0, wheels.transform(), _imu(poses, 0, 0, bias))]
    for last in range(each, len(poses), each):
        for middle in (last - each // 2, last):
            step = poses[middle - each // 2].inverse() @ poses[middle]
            wheels = wheels @ Pose2D(step.x * (1 - drift), step.y, step.yaw * (1 + drift))
            imu = _imu(poses, middle - each // 2 + 1, middle, bias)
            told.append((middle * SAMPLE, wheels.transform(), imu))
        stamp = last * SAMPLE
        turn = turn_of(motion, stamp, boxes, seed * 100_003 + last, noise)
        yield Moment(stamp, poses[last].transform(), told, turn)
        told = []


def _imu(poses: list[Pose2D], first: int, last: int, bias: float) -> ImuReading:
    times = np.arange(first, last + 1) * SAMPLE
    rates, forces = np.zeros((len(times), 3)), np.tile(GRAVITY, (len(times), 1))
    for row, number in enumerate(range(first, last + 1)):
        if number:
            turned = math.remainder(poses[number].yaw - poses[number - 1].yaw, 2 * math.pi)
            rates[row, 2] = turned / SAMPLE
    return ImuReading(float(times[-1]), "base_link", times, rates + bias, forces)

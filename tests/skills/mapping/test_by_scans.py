"""How the base moved, told by the scans alone."""

from __future__ import annotations

import math

import numpy as np
from momantu_skills.mapping.logs.by_scans import reckoned
from momantu_skills.mapping.logs.transforms import Transforms
from momantu_skills.navigation.map.sensing import Rays

from momantu_bt.geometry import Pose2D, Transform
from tests.skills.mapping.walls import RING, error, seen

STEP = 0.1


def smooth(turns: int) -> list[Pose2D]:
    """Once around the block, 10 cm from scan to scan, with bends of 1 m at the corners."""
    poses = [Pose2D(2.5, 1.5, 0.0)]
    for side in range(turns):
        straight = 11.0 if side % 2 == 0 else 7.0
        bends = [0.0] * round(straight / STEP) + [STEP] * round(math.pi / 2 / STEP)
        for bend in bends:
            poses.append(poses[-1] @ Pose2D(STEP, 0.0, bend))
    return poses


def scans(poses: list[Pose2D], every: float = 0.1) -> list[tuple[float, Rays]]:
    noise = np.random.default_rng(5)
    return [(every * n, seen(RING, pose, noise)) for n, pose in enumerate(poses)]


def test_a_way_around_a_block_ends_where_it_began() -> None:
    way = smooth(4)
    found = reckoned(scans(way))
    assert found.matched == len(way)
    assert found.odom_from_base[0] == Pose2D(0.0, 0.0)
    assert error(found.odom_from_base, way) < 0.1
    end = way[0].inverse() @ way[-1]
    assert found.odom_from_base[-1].distance_to(end) < 0.3


def test_who_stands_still_does_not_drift() -> None:
    found = reckoned(scans([Pose2D(2.0, 1.5, 0.3)] * 60))
    far = [math.hypot(pose.x, pose.y) for pose in found.odom_from_base]
    assert max(far) < 0.02


def test_after_a_pause_in_the_log_the_base_is_taken_to_stand() -> None:
    way = smooth(1)[:60]
    paused = [
        (stamp + (20.0 if n >= 40 else 0.0), rays)
        for n, (stamp, rays) in enumerate(scans([*way[:40], *way[39:59]]))
    ]
    found = reckoned(paused)
    assert found.odom_from_base[40].distance_to(found.odom_from_base[39]) < 0.05


def test_the_carrier_is_the_highest_frame_on_which_a_laser_stays() -> None:
    told = Transforms()
    assert told.carrier("/laser") == "laser"
    told.add("base_link", "laser", 0.0, Transform((0.2, 0.0, 0.3)))
    assert told.carrier("laser") == "base_link"
    for n in range(3):
        told.add("map", "base_link", float(n), Transform((0.1 * n, 0.0, 0.0)))
    assert told.carrier("laser") == "base_link"

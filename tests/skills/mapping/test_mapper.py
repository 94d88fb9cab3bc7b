"""The mapper on simulated ways: drift is undone, loops close, the same log gives the same map."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from momantu_skills.mapping import pose_graph
from momantu_skills.mapping.building import build
from momantu_skills.mapping.loops import Loop, bears_out
from momantu_skills.mapping.mapper import Mapper
from momantu_skills.mapping.pose_graph import Match
from momantu_skills.navigation.matching.config import MatchingConfig

from momantu_bt.errors import InputError
from momantu_bt.formats.maps import FREE, OCCUPIED
from momantu_bt.geometry import Pose2D
from tests.skills.mapping.walls import ROUND, driven, error, logged, seen


def never(done, loops):
    return False


@pytest.fixture(scope="module")
def way():
    return driven(ROUND, 0.5)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_round_closes_and_its_drift_is_gone(way, seed):
    scans = logged(way, seed)
    drift = error([scan.odom_from_base for scan in scans], way)
    built = build(scans, 0.05, never)
    assert built.report["loops"] > 0
    assert error(built.poses, way) < min(0.05, drift / 3)


def test_the_same_log_gives_the_same_map_bit_for_bit(way):
    first, second = (build(logged(way, 4), 0.05, never) for _ in range(2))
    assert first.poses == second.poses
    assert np.array_equal(first.plan.levels, second.plan.levels)


def test_the_floor_plan_has_walls_where_they_are_and_none_twice(way):
    built = build(logged(way, 5), 0.05, never)
    cells, resolution = built.plan.cells(), built.plan.resolution
    # map_from_base of the first scan is the origin, and the way begins along x
    wanted = [(x - way[0].x, y - way[0].y) for x, y in ((8.0, 0.0), (8.0, 3.0), (0.0, 2.0))]
    for x, y in wanted:
        column = round((x - built.plan.origin[0]) / resolution)
        row = round((y - built.plan.origin[1]) / resolution)
        near = cells[row - 3 : row + 4, column - 3 : column + 4]
        assert (near == OCCUPIED).any(), (x, y)
    # a line across the corridor meets its two walls, each at most three cells thick
    column = round((4.6 - way[0].x - built.plan.origin[0]) / resolution)
    low = round((-1.0 - way[0].y - built.plan.origin[1]) / resolution)
    across = cells[low : low + round(4.3 / resolution), column] == OCCUPIED
    starts = np.flatnonzero(np.diff(across.astype(int)) == 1)
    assert len(starts) == 2
    assert across.sum() <= 6
    assert (cells == FREE).sum() * resolution**2 == pytest.approx(16 * 12 - 60, rel=0.06)


def test_a_scan_of_nothing_follows_odometry():
    scans = logged(driven([(1.5, 1.5), (5.0, 1.5)], 0.5), 6, walls=[])
    mapper = Mapper()
    for scan in scans:
        mapper.add(scan.odom_from_base, scan.rays)
    mapper.finish()
    assert mapper.poses[-1].distance_to(mapper.poses[0]) == pytest.approx(
        scans[-1].odom_from_base.distance_to(scans[0].odom_from_base), abs=1e-6
    )
    with pytest.raises(InputError, match="no beam hit anything"):
        build(scans, 0.05, never)


def test_a_standing_robot_adds_no_scans_but_has_its_poses(way):
    scans = logged([way[0]] * 5 + way[:6], 7)
    built = build(scans, 0.05, never)
    assert len(built.poses) == len(built.stamps) == 11
    assert built.report["scans"] == 6


def test_progress_can_end_the_mapping(way):
    scans = logged(way, 8)
    built = build(scans, 0.05, lambda done, loops: done == 12)
    assert built.interrupted
    assert len(built.poses) == built.report["scans_read"] == 12


def test_the_estimate_is_good_at_once(way):
    mapper, worst = Mapper(), 0.0
    for pose, scan in zip(way, logged(way, 9), strict=True):
        tracked = mapper.add(scan.odom_from_base, scan.rays)
        there = way[0].inverse() @ pose
        worst = max(worst, mapper.poses[-1].distance_to(there))
        assert 0.0 <= tracked.score <= 1.0
    assert worst < 0.25


def test_a_wrong_loop_loses_its_influence():
    config = MatchingConfig()
    step = Pose2D(1.0, 0.0, 0.0)
    scans = [Pose2D(float(k), 0.0) for k in range(20)]
    tight = np.diag([0.02**2, 0.02**2, 0.005**2])
    matches = [
        Match(k // 4, n, scans[4 * (k // 4)].inverse() @ scans[n], tight)
        for k in range(20)
        for n in (k, min(k + 1, 19))
    ]
    origins = [scans[4 * k] for k in range(5)]
    wrong = Loop(0, 4, Pose2D(9.0, 3.0, 1.0))
    found, _ = pose_graph.optimise(scans, origins, [step] * 19, matches, [wrong], config)
    assert max(a.distance_to(b) for a, b in zip(found, scans, strict=True)) < 0.1


def test_right_loops_pull_a_bent_way_straight():
    config = MatchingConfig()
    bent = [Pose2D(0.0, 0.0)]
    for _ in range(39):
        bent.append(bent[-1] @ Pose2D(1.0, 0.0, math.tau / 40 + 0.01))
    true = [Pose2D(0.0, 0.0)]
    for _ in range(39):
        true.append(true[-1] @ Pose2D(1.0, 0.0, math.tau / 40))
    motions = [a.inverse() @ b for a, b in itertools.pairwise(bent)]
    loose = np.diag([0.02**2, 0.02**2, 0.01**2])
    matches = [
        Match(k, n, bent[k].inverse() @ bent[n], loose)
        for k in range(40)
        for n in (k, k + 1)
        if n < 40
    ]
    loops = [Loop(k, 39 - j, true[k].inverse() @ true[39 - j]) for k in (0, 1) for j in (0, 1)]
    found, _ = pose_graph.optimise(bent, bent, motions, matches, loops, config)
    assert error(found, true) < 0.3 * error(bent, true)


def test_loops_of_two_submaps_bear_each_other_out_if_they_agree():
    origins = [Pose2D(2.0 * k, 0.0, 0.1 * k) for k in range(9)]

    def loop(older, newer, off=0.0, turn=0.0):
        return Loop(
            older, newer, origins[older].inverse() @ origins[newer] @ Pose2D(off, 0.0, turn)
        )

    one = loop(1, 6)
    assert bears_out(loop(2, 7), one, origins)
    assert bears_out(loop(1, 7, 0.2, 0.03), one, origins)
    assert not bears_out(loop(2, 7, 2.0), one, origins)
    assert not bears_out(loop(2, 7, 0.0, 0.3), one, origins)
    assert not bears_out(loop(2, 6), one, origins), "of the same submap"
    assert not bears_out(loop(5, 8), one, origins), "of another place"
    assert not bears_out(one, one, origins)


def test_loops_that_correct_drift_alike_bear_each_other_out():
    origins = [Pose2D(2.0 * k, 0.0) for k in range(9)]
    drift = Pose2D(0.0, 3.0, 0.2)
    one, other = (Loop(k, k + 5, origins[k].inverse() @ drift @ origins[k + 5]) for k in (1, 2))
    assert bears_out(other, one, origins)


@pytest.mark.parametrize("odd", [40, 60])
def test_a_scan_that_matches_nothing_stays_where_odometry_has_it(way, odd):
    """It shows a bare wall, like many that there are: one 7 m away was taken for it."""
    scans = logged(way, 3)
    bare = seen([(1.5, -2.0, 1.5, 2.0)], Pose2D(0.0, 0.0), np.random.default_rng(0))
    scans[odd] = replace(scans[odd], rays=bare)
    mapper = Mapper()
    for scan in scans:
        mapper.add(scan.odom_from_base, scan.rays)
    mapper.finish()
    assert mapper.loops
    assert error(mapper.poses, way) < 0.05

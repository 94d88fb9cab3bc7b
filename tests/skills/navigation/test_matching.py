"""Scan matching: searches find what trying every pose finds, lines pull a scan into place."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from momantu_skills.navigation.matching import likelihood, lines, search
from momantu_skills.navigation.matching.config import MatchingConfig
from momantu_skills.navigation.matching.poses import as_array
from momantu_skills.navigation.matching.scan import ScanPoints
from momantu_skills.navigation.matching.submap import Growing

from momantu_bt.geometry import Pose2D
from tests.skills.mapping.walls import RING, seen

CELL = 0.05
CORNER = np.array([-5.0, -5.0])


def grid_of(points):
    grid = np.zeros((200, 200), dtype=np.uint8)
    bound = grid.copy()
    likelihood.add_ends(grid, bound, CORNER, CELL, points, likelihood.stencil(0.06, CELL))
    return grid, bound


@pytest.mark.parametrize("seed", range(5))
def test_the_local_search_finds_the_best_pose_of_all(seed):
    random = np.random.default_rng(seed)
    grid, bound = grid_of(random.uniform(-3.0, 3.0, (60, 2)))
    points = random.uniform(-2.0, 2.0, (25, 2))
    expected, deviation = np.array([0.1, -0.2, 0.3]), np.array([0.2, 0.1])
    score, pose = likelihood.best_pose(
        grid, bound, CORNER, CELL, points, expected, np.array([0.2, 0.04]), 0.02, deviation
    )
    best = -1.0
    for turn, right, up in itertools.product(range(-2, 3), range(-4, 8), range(-4, 8)):
        yaw = expected[2] + turn * 0.02
        cells = likelihood.cells_at(points, np.array([*expected[:2], yaw]), CORNER, CELL)
        there = likelihood.share(grid, cells, right, up, 1)
        far = (right**2 + up**2) * (CELL / 0.2) ** 2 + (turn * 0.02 / 0.1) ** 2
        best = max(best, there - likelihood.SURPRISE * far)
    assert score >= best - 1e-9
    cells = likelihood.cells_at(points, pose, CORNER, CELL)
    there = likelihood.share(grid, cells, 0, 0, 1)
    assert there == pytest.approx(score, abs=0.2)


@pytest.mark.parametrize("seed", range(5))
def test_the_wide_search_finds_the_best_pose_of_all(seed):
    random = np.random.default_rng(seed)
    grid, _ = grid_of(random.uniform(-3.0, 3.0, (60, 2)))
    points = random.uniform(-2.0, 2.0, (25, 2))
    expected = np.array([0.1, -0.2, 0.3])
    score, pose = search.search(
        search.pyramid(grid), CORNER, CELL, points, expected, np.array([1.0, 0.06]), 0.03, 0.0
    )
    scores = []
    for turn in range(-2, 3):
        yaw = expected[2] + turn * 0.03
        cells = likelihood.cells_at(points, np.array([*expected[:2], yaw]), CORNER, CELL)
        moves = itertools.product(range(-32, 64), repeat=2)
        scores.append(max(likelihood.share(grid, cells, right, up, 1) for right, up in moves))
    assert score == pytest.approx(max(scores))
    found = likelihood.cells_at(points, pose, CORNER, CELL)
    assert likelihood.share(grid, found, 0, 0, 1) == pytest.approx(score, abs=0.05)


def test_a_search_below_the_least_score_finds_nothing():
    grid, _ = grid_of(np.zeros((1, 2)))
    points = np.random.default_rng(0).uniform(-2.0, 2.0, (25, 2))
    window = np.array([0.5, 0.1])
    found = search.search(
        search.pyramid(grid), CORNER, CELL, points, np.zeros(3), window, 0.03, 0.9
    )
    assert found[0] == -1.0


def test_each_level_of_the_pyramid_bounds_its_block():
    grid = np.random.default_rng(0).integers(0, 255, (40, 50)).astype(np.uint8)
    levels = search.pyramid(grid)
    for k in range(search.LEVELS + 1):
        for row, column in ((0, 0), (7, 3), (20, 31)):
            block = grid[row : row + 2**k, column : column + 2**k]
            assert levels[k, row, column] >= block.max()


@pytest.mark.parametrize("off", [(0.15, -0.1, 0.05), (-0.2, 0.1, -0.08)])
def test_lines_pull_a_scan_into_place(off):
    noise = np.random.default_rng(1)
    config = MatchingConfig()
    at, there = Pose2D(1.5, 1.5, 0.4), Pose2D(1.8, 1.6, 0.6)
    growing = Growing(config)
    growing.add(at, ScanPoints.from_rays(seen(RING, at, noise), config.longest))
    scan = ScanPoints.from_rays(seen(RING, there, noise), config.longest)
    start = as_array(there) + np.array(off)
    pose, information, misfit, count = lines.lay_on(
        growing.index,
        growing.points,
        growing.normals,
        growing.corner,
        config.resolution,
        scan.points,
        scan.normals,
        start,
        start,
        np.array([1.0, 1.0]),
        1.0,
        0.12,
    )
    assert np.abs(pose - as_array(there)).max() < 0.02
    assert (np.linalg.eigvalsh(information) > 0).all()
    assert misfit < 0.03
    assert count > 100


def test_a_corridor_says_nothing_about_the_way_along_it():
    noise = np.random.default_rng(2)
    walls = [(-50.0, 0.0, 50.0, 0.0), (-50.0, 2.0, 50.0, 2.0)]
    config = MatchingConfig()
    scan = ScanPoints.from_rays(seen(walls, Pose2D(0.0, 1.0), noise), config.longest)
    growing = Growing(config)
    growing.add(Pose2D(0.0, 0.0), scan)
    _, information, _, _ = lines.lay_on(
        growing.index,
        growing.points,
        growing.normals,
        growing.corner,
        config.resolution,
        scan.points,
        scan.normals,
        np.zeros(3),
        np.zeros(3),
        np.array([0.1, 0.1]),
        1.0,
        0.12,
    )
    assert information[0, 0] < 0.05 * information[1, 1]


def test_normals_point_to_the_sensor_and_across_the_wall():
    noise = np.random.default_rng(3)
    rays = seen([(-5.0, 2.0, 5.0, 2.0)], Pose2D(0.0, 0.0, 1.57), noise)
    scan = ScanPoints.from_rays(rays, 25.0)
    across = Pose2D(0.0, 0.0, 1.57).apply(scan.normals)
    named = (scan.normals != 0).any(axis=1)
    assert named.mean() > 0.9
    assert (across[named, 1] < -0.9).all()

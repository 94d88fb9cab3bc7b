"""How poses explain scans: the kernels against plain arithmetic, and wherever the map lies."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.navigation.localize.fit import scan_fit
from momantu_skills.navigation.localize.particle_filter import likelihood_field, log_likelihoods
from momantu_skills.navigation.map.fields import surface_distance
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.map.sensing import Rays
from scipy.ndimage import map_coordinates

from momantu_bt.formats.maps import OCCUPIED
from momantu_bt.geometry import Pose2D

SEEDS = st.integers(0, 10_000)


def _scenery(seed: int, origin: tuple[float, float] = (0.0, 0.0)) -> GridMap:
    """A walled room of 6 m x 5 m with three boxes."""
    random = np.random.default_rng(seed)
    cells = np.zeros((100, 120), np.uint8)
    cells[[0, -1], :] = OCCUPIED
    cells[:, [0, -1]] = OCCUPIED
    for row, column in random.integers(15, 80, (3, 2)):
        cells[row : row + 8, column : column + 8] = OCCUPIED
    return GridMap(cells, 0.05, origin)


def _field(grid: GridMap) -> np.ndarray:
    return surface_distance(grid.cells == OCCUPIED, grid.resolution, 0.5)


def _exact_scan(grid: GridMap, pose: Pose2D, beams: int = 90) -> Rays:
    """Beams from the base's centre, walked in steps of 2 mm to the first occupied cell."""
    angles = np.linspace(-math.pi, math.pi, beams, endpoint=False)
    ways = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    turned = ways @ np.array([[c, s], [-s, c]])
    steps = np.arange(0.0, 9.0, 0.002)
    points = np.array([pose.x, pose.y]) + steps[None, :, None] * turned[:, None, :]
    cells = np.floor((points - np.array(grid.origin)) / grid.resolution).astype(int)
    top = np.array(grid.cells.shape)[::-1] - 1
    cells = np.clip(cells, 0, top)
    met = grid.cells[cells[..., 1], cells[..., 0]] == OCCUPIED
    return Rays(np.zeros(2), ways, steps[met.argmax(axis=1)], met.any(axis=1))


def _free_pose(grid: GridMap, seed: int) -> Pose2D:
    random = np.random.default_rng(seed)
    field = surface_distance(grid.cells == OCCUPIED, grid.resolution, 5.0)
    rows, columns = np.nonzero((field > 0.3) & (grid.cells != OCCUPIED))
    n = int(random.integers(len(rows)))
    x, y = grid.origin
    return Pose2D(
        x + (columns[n] + 0.5) * 0.05, y + (rows[n] + 0.5) * 0.05, random.uniform(-3.1, 3.1)
    )


@settings(max_examples=30)
@given(SEEDS, st.integers(1, 80))
def test_the_sum_of_logs_is_that_of_each_beam(seed: int, beams: int) -> None:
    random = np.random.default_rng(seed)
    field = random.uniform(0.05, 1.0, (30, 40)).astype(np.float32)
    poses = np.column_stack([random.uniform(0, 3, (6, 2)), random.uniform(-4, 4, 6)])
    points = random.uniform(-2, 2, (beams, 2))
    outside = 0.02
    found = log_likelihoods(poses, points, field, 1.0, 0.5, 0.1, outside)
    for pose, total in zip(poses, found, strict=True):
        c, s = math.cos(pose[2]), math.sin(pose[2])
        ends = points @ np.array([[c, s], [-s, c]]) + pose[:2]
        column, row = (ends[:, 0] - 1.0) / 0.1 - 0.5, (ends[:, 1] - 0.5) / 0.1 - 0.5
        inside = (column >= 0) & (row >= 0) & (column < 39) & (row < 29)
        values = map_coordinates(field, [row[inside], column[inside]], order=1, mode="nearest")
        expected = np.log(values).sum() + (~inside).sum() * math.log(outside)
        assert total == pytest.approx(expected, rel=1e-4, abs=1e-3)


def test_thousands_of_unlikely_beams_do_not_underflow() -> None:
    field = np.full((20, 20), 1e-3, np.float32)
    points = np.zeros((5000, 2))
    (total,) = log_likelihoods(np.array([[1.0, 1.0, 0.0]]), points, field, 0.0, 0.0, 0.1, 0.5)
    assert total == pytest.approx(5000 * math.log(np.float32(1e-3)), rel=1e-6)


@given(st.floats(0.01, 0.2), st.floats(0.01, 0.5))
def test_likelihood_falls_with_distance_to_the_random_share(sigma: float, share: float) -> None:
    distance = np.linspace(0.0, 2.0, 100, dtype=np.float32)[None]
    field = likelihood_field(distance, sigma, share)
    assert (np.diff(field) <= 1e-7).all()
    assert field[0, 0] == pytest.approx(1.0, abs=1e-6)
    assert field[0, -1] == pytest.approx(share, abs=1e-6)
    one = likelihood_field(np.array([[sigma]], dtype=np.float32), sigma, share)
    assert one[0, 0] == pytest.approx((1 - share) * math.exp(-0.5) + share, rel=1e-4)


@settings(max_examples=25)
@given(SEEDS)
def test_the_true_pose_explains_its_scan_best(seed: int) -> None:
    grid = _scenery(seed)
    pose = _free_pose(grid, seed)
    rays = _exact_scan(grid, pose)
    field = likelihood_field(_field(grid), 0.05, 0.15)
    random = np.random.default_rng(seed)
    off = random.normal(size=(30, 3))
    off *= np.array([0.3, 0.3, 0.3]) / np.linalg.norm(off, axis=1, keepdims=True)
    truth = np.array([pose.x, pose.y, pose.yaw])
    values = log_likelihoods(
        np.vstack([truth, truth + off]), rays.points(), field, 0.0, 0.0, 0.05, 0.15
    )
    assert values[0] > values[1:].max()
    assert scan_fit(grid, _field(grid), pose, rays) == 1.0


@settings(max_examples=15)
@given(SEEDS, st.floats(-40.0, 40.0), st.floats(-40.0, 40.0))
def test_moving_map_and_pose_together_changes_nothing(seed: int, x: float, y: float) -> None:
    fits = []
    for origin in ((0.0, 0.0), (x, y)):
        grid = _scenery(seed, origin)
        pose = _free_pose(grid, seed)
        rays = _exact_scan(grid, pose)
        wrong = Pose2D(pose.x + 0.4, pose.y - 0.3, pose.yaw + 0.4)
        fits.append([scan_fit(grid, _field(grid), at, rays) for at in (pose, wrong)])
    assert fits[0] == pytest.approx(fits[1], abs=0.06)
    assert fits[0][1] < fits[0][0]


def test_early_beams_are_weaker_evidence_than_beams_through_walls() -> None:
    grid = GridMap(_scenery(0).cells.copy(), 0.05, (0.0, 0.0))
    grid.cells[1:-1, 1:-1] = 0
    pose = Pose2D(3.0, 2.5, 0.0)
    rays = _exact_scan(grid, pose)
    early = Rays(rays.origin, rays.directions, 0.6 * rays.ranges, rays.hit)
    through = Rays(rays.origin, rays.directions, 1.4 * rays.ranges, rays.hit)
    half = np.arange(rays.ranges.size) % 2 == 0

    def mixed(other: Rays) -> float:
        ranges = np.where(half, rays.ranges, other.ranges)
        seen = Rays(rays.origin, rays.directions, ranges, rays.hit)
        return scan_fit(grid, _field(grid), pose, seen)

    assert 1.0 > mixed(early) > mixed(through)
    assert mixed(through) == pytest.approx(0.5, abs=0.02)
    assert mixed(early) == pytest.approx(1.0 / 1.4, abs=0.02)

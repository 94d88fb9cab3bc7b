"""Drawing particles: unbiased, never without weight, and as many as the bound asks for."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.navigation.localize.belief import (
    CLUSTER_RADIUS,
    covariance,
    differences,
    main_cluster,
    mean_pose,
)
from momantu_skills.navigation.localize.particle_filter import kld_resample

from momantu_bt.geometry import Pose2D

SEEDS = st.integers(0, 10_000)
POSES = st.builds(Pose2D, st.floats(-5, 5), st.floats(-5, 5), st.floats(-3.1, 3.1))


def _draw(poses: np.ndarray, weights: np.ndarray, uniforms: np.ndarray, fewest: int) -> np.ndarray:
    chosen: np.ndarray = kld_resample(poses, weights, uniforms, fewest, 0.1, 0.1, 0.05, 2.33)
    return chosen


def test_the_mean_of_many_draws_is_the_weighted_mean() -> None:
    random = np.random.default_rng(4)
    poses, weights = random.normal(size=(50, 3)), random.random(50) ** 3
    weights /= weights.sum()
    chosen = _draw(poses, weights, random.random(40_000), 40_000)
    drawn = poses[chosen].mean(axis=0)
    spread = np.sqrt(weights @ (poses - weights @ poses) ** 2 / 40_000)
    assert (np.abs(drawn - weights @ poses) < 5 * spread).all()


@given(SEEDS)
def test_what_has_no_weight_is_never_drawn(seed: int) -> None:
    random = np.random.default_rng(seed)
    weights = np.where(random.random(40) < 0.7, 0.0, random.random(40))
    weights[int(random.integers(40))] = 1.0
    weights /= weights.sum()
    uniforms = np.concatenate([[0.0, np.nextafter(1.0, 0.0)], random.random(500)])
    chosen = _draw(random.normal(size=(40, 3)), weights, uniforms, 502)
    assert (weights[chosen] > 0.0).all()


@given(SEEDS)
def test_each_draw_is_the_inverse_of_the_cumulated_weights(seed: int) -> None:
    random = np.random.default_rng(seed)
    weights = random.random(30)
    weights /= weights.sum()
    uniforms = random.random(100)
    chosen = _draw(np.zeros((30, 3)), weights, uniforms, 100)
    edges = np.concatenate([[0.0], np.cumsum(weights)])
    assert (edges[chosen] <= uniforms + 1e-12).all()
    assert (uniforms <= edges[chosen + 1] + 1e-12).all()


@settings(max_examples=30)
@given(SEEDS, st.floats(0.01, 1.5))
def test_it_stops_at_foxs_bound_for_the_bins_so_far(seed: int, sigma: float) -> None:
    random = np.random.default_rng(seed)
    poses = random.normal(size=(400, 3)) * sigma
    chosen = _draw(poses, np.full(400, 1 / 400), random.random(30_000), 50)
    turned = poses[:, 2] % (2 * math.pi)
    keys = [
        (math.floor(x / 0.1), math.floor(y / 0.1), math.floor(t / 0.1))
        for (x, y, _), t in zip(poses, turned, strict=True)
    ]
    bins: set[tuple[int, int, int]] = set()
    needed = 50
    for count, i in enumerate(chosen, start=1):
        assert count <= needed
        bins.add(keys[i])
        k = len(bins) - 1
        if k > 0:
            a = 2 / (9 * k)
            bound = math.ceil(k / 0.1 * (1 - a + math.sqrt(a) * 2.33) ** 3)
            needed = max(50, bound)
    assert len(chosen) == needed


@given(SEEDS, st.integers(-3, 3))
def test_whole_turns_of_a_heading_are_the_same_bin(seed: int, turns: int) -> None:
    random = np.random.default_rng(seed)
    poses = np.column_stack([random.normal(size=(300, 2)), random.uniform(0.01, 6.2, 300)])
    poses[:, 2] = np.floor(poses[:, 2] / 0.1) * 0.1 + 0.05
    uniforms = random.random(5000)
    counts = []
    for turn in (0, turns):
        wound = poses + np.array([0.0, 0.0, 2 * math.pi * turn])
        counts.append(len(_draw(wound, np.full(300, 1 / 300), uniforms, 50)))
    assert counts[0] == counts[1]


@settings(max_examples=40)
@given(SEEDS, POSES)
def test_moving_the_whole_cloud_moves_what_it_says(seed: int, frame: Pose2D) -> None:
    random = np.random.default_rng(seed)
    poses = random.normal(size=(80, 3)) * 0.3
    weights = random.random(80)
    moved = np.array(
        [(p.x, p.y, p.yaw) for p in (frame @ Pose2D(*(float(v) for v in q)) for q in poses)]
    )
    mean, there = mean_pose(poses, weights), mean_pose(moved, weights)
    expected = frame @ mean
    assert there.distance_to(expected) < 1e-9
    assert differences(np.array([[0, 0, there.yaw]]), expected)[0, 2] == pytest.approx(0, abs=1e-9)
    c, s = math.cos(frame.yaw), math.sin(frame.yaw)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    here = covariance(poses, weights, mean)
    assert covariance(moved, weights, there) == pytest.approx(turn @ here @ turn.T, abs=1e-9)


@settings(max_examples=40)
@given(SEEDS, POSES)
def test_the_covariance_is_that_of_numpy_for_a_narrow_cloud(seed: int, centre: Pose2D) -> None:
    random = np.random.default_rng(seed)
    offsets = random.normal(size=(60, 3)) * 0.02
    weights = random.integers(1, 5, 60).astype(float)
    offsets -= np.average(offsets, axis=0, weights=weights)
    poses = offsets + np.array([centre.x, centre.y, centre.yaw])
    found = covariance(poses, weights, mean_pose(poses, weights))
    expected = np.cov(offsets.T, fweights=weights.astype(int), ddof=0)
    assert found == pytest.approx(expected, abs=1e-6)


@settings(max_examples=40)
@given(SEEDS, POSES, st.floats(1.0, 4.0), st.floats(-3.1, 3.1))
def test_the_guess_is_kept_while_most_of_the_weight_is_there(
    seed: int, centre: Pose2D, apart: float, bearing: float
) -> None:
    random = np.random.default_rng(seed)
    there = centre @ Pose2D(apart * math.cos(bearing), apart * math.sin(bearing), 0.5)
    clouds = [
        np.array([p.x, p.y, p.yaw]) + np.clip(random.normal(size=(100, 3)), -3, 3) * 0.03
        for p in (centre, there)
    ]
    poses = np.vstack(clouds)
    for share in (0.6, 0.3):
        weights = np.repeat([share / 100, (1 - share) / 100], 100)
        found = main_cluster(poses, weights, centre)
        assert found.distance_to(centre if share > 0.5 else there) < 0.1 * CLUSTER_RADIUS

"""Rays: where a scan's hits lie, and that thinning keeps what was hit."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.navigation.map.sensing import SPREAD, Rays

from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.messages import LaserScan, frozen

SEEDS = st.integers(0, 10_000)
MOUNTS = st.builds(Pose2D, st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-3.1, 3.1))


def _scan(ranges: np.ndarray, first: float = -1.9) -> LaserScan:
    return LaserScan(0.0, "laser", first, 3.8 / 180, 0.05, 25.0, frozen(ranges))


@given(SEEDS, MOUNTS, st.floats(0.1, 1.0), st.booleans())
def test_hits_lie_where_the_whole_transform_puts_them(
    seed: int, mount: Pose2D, height: float, upside_down: bool
) -> None:
    ranges = np.random.default_rng(seed).uniform(0.1, 20.0, 181)
    turn = Transform(quaternion=(0.0, 1.0, 0.0, 0.0)) if upside_down else Transform()
    base_from_laser = mount.transform(height) @ turn
    angles = -1.9 + 3.8 / 180 * np.arange(181)
    flat = np.column_stack([ranges * np.cos(angles), ranges * np.sin(angles), 0 * angles])
    rays = Rays.from_scan(_scan(ranges), base_from_laser)
    assert rays.points() == pytest.approx(base_from_laser.apply(flat)[:, :2], abs=1e-9)
    assert np.hypot(*rays.directions.T) == pytest.approx(np.ones(181))


@pytest.mark.parametrize(
    ("value", "hit"),
    [(0.05, True), (0.049, False), (24.99, True), (25.0, False), (math.inf, False), (0.0, False)],
)
def test_only_ranges_within_the_sensors_are_hits(value: float, hit: bool) -> None:
    rays = Rays.from_scan(_scan(np.full(181, value)), Transform())
    assert rays.hit.all() == rays.hit.any() == hit


def test_a_range_that_is_no_number_is_no_hit() -> None:
    rays = Rays.from_scan(_scan(np.array([1.0, math.nan, 2.0])), Transform())
    assert rays.hit.tolist() == [True, False, True]
    assert len(rays.points()) == 2


@settings(max_examples=60)
@given(SEEDS, st.integers(1, 60))
def test_thinned_hits_are_hits_one_per_place_and_about_as_many(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    ranges = random.uniform(0.3, 6.0) * (1 + 0.5 * np.sin(np.linspace(0, 9, 181)))
    rays = Rays.from_scan(_scan(ranges), Transform())
    every, few = rays.points(), rays.thinned(count)
    assert {tuple(p) for p in few} <= {tuple(p) for p in every}
    cells = np.floor(few / SPREAD).astype(int)
    assert len(np.unique(cells, axis=0)) == len(few)
    places = len(np.unique(np.floor(every / SPREAD).astype(int), axis=0))
    assert min(places, count) / 2 <= len(few) <= 2 * count + 1


def test_nothing_hit_is_nothing_thinned() -> None:
    rays = Rays.from_scan(_scan(np.full(181, 25.0)), Transform())
    assert rays.points().shape == rays.thinned(60).shape == (0, 2)

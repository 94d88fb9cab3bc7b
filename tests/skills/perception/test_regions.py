"""Regions: hulls, growing and depth agree with each other."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.perception.geometry.regions import (
    Region,
    convex_hull,
    depth_inside,
    disc,
    grown,
    surface_corners,
)

from momantu_bt.frames import FrameBuffer
from momantu_bt.geometry import Pose2D
from momantu_bt.testing import ScriptedRobot, small_robot
from momantu_bt.world import Surface

seeds = st.integers(0, 10_000)


def cloud(seed: int, count: int = 60) -> np.ndarray:
    return np.random.default_rng(seed).normal(0.0, 1.0, (count, 2)) + 5.0


@given(seeds)
def test_a_hull_is_counter_clockwise_and_holds_its_points(seed: int) -> None:
    points = cloud(seed)
    hull = convex_hull(points)
    x, y = hull.T
    assert (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() > 0
    assert depth_inside(points, hull).min() > -1e-5
    assert {tuple(corner) for corner in hull} <= {tuple(point) for point in points}


@given(seeds, st.floats(0.01, 0.5))
def test_growing_moves_every_edge_outwards(seed: int, by: float) -> None:
    hull = convex_hull(cloud(seed, 12))
    assert depth_inside(hull, grown(hull, by)).min() == pytest.approx(by, abs=1e-6)


@given(seeds)
def test_depth_in_a_disc_is_its_radius_less_the_distance(seed: int) -> None:
    outline = disc(np.array([1.0, 2.0]), 0.5, corners=200)
    points = np.random.default_rng(seed).uniform(-0.3, 0.3, (20, 2)) + np.array([1.0, 2.0])
    distances = np.linalg.norm(points - (1.0, 2.0), axis=1)
    assert depth_inside(points, outline) == pytest.approx(0.5 - distances, abs=1e-3)


def test_a_region_has_a_floor_and_a_ceiling() -> None:
    region = Region(disc(np.zeros(2), 1.0), 0.4, 0.9)
    points = np.array([[0, 0, 0.5], [0, 0, 0.3], [0, 0, 1.0], [1.2, 0, 0.5], [-0.5, 0.5, 0.9]])
    assert region.contains(points).tolist() == [True, False, False, False, True]
    assert region.contains(np.empty((0, 3))).shape == (0,)


def test_a_surface_lies_in_odom_where_localization_puts_it() -> None:
    frames = FrameBuffer(small_robot().kinematics())
    frames.add_state(ScriptedRobot().state())
    map_from_odom = Pose2D(1.0, 2.0, np.pi / 2).transform()
    frames.set_map_from_odom(map_from_odom, 0.0)
    surface = Surface(Pose2D(3.0, 2.0, 0.0), (0.4, 1.0), 0.7, (0.0,))
    corners = surface_corners(surface, frames)
    assert corners.mean(axis=0) == pytest.approx((0.0, -2.0, 0.7), abs=1e-9)
    assert np.ptp(corners, axis=0) == pytest.approx((1.0, 0.4, 0.0), abs=1e-9)

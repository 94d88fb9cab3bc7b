"""Planes: the surface that things stand on, level in spite of how the camera is mounted."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.perception.geometry.regions import depth_inside
from momantu_skills.perception.surface.planes import PlaneConfig, find_plane, measure_support

from momantu_bt.geometry import Transform, quaternion_from_rpy
from momantu_bt.testing.painting import Block, Round
from tests.skills.scenery.onlooker import Viewed

TOP = 0.72
TABLE = Block((0.6, 1.2, 0.03), (1.0, 0.0, TOP - 0.015))
CONFIG = PlaneConfig()


def patch(seed: int, slope: tuple[float, float], height: float) -> np.ndarray:
    """Points of a tilted table of 0.6 by 1 m, and a box's top 5 cm above a part of it."""
    random = np.random.default_rng(seed)
    flat = random.uniform((-0.3, -0.5), (0.3, 0.5), (4000, 2))
    z = height + flat @ np.array(slope) + 0.002 * random.standard_normal(4000)
    z[(flat[:, 0] > 0.1) & (flat[:, 1] > 0.2)] += 0.05
    return np.column_stack([flat, z])


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 1000), st.floats(-0.02, 0.02), st.floats(-0.02, 0.02), st.floats(0.68, 0.76))
def test_height_and_tilt_are_found_under_what_stands_there(
    seed: int, across: float, along: float, height: float
) -> None:
    points = patch(seed, (across, along), height)
    plane = find_plane(points, 0.6, 0.85, CONFIG)
    assert plane is not None
    assert plane.slope == pytest.approx((across, along), abs=0.001)
    on_table = ~((points[:, 0] > 0.1) & (points[:, 1] > 0.2))
    assert np.abs(plane.above(points)[on_table].mean()) < 0.0005
    assert not plane.inliers[~on_table].any()
    assert plane.area == pytest.approx(0.54, abs=0.06)


def test_a_tilt_beyond_what_errors_explain_is_not_believed() -> None:
    plane = find_plane(patch(0, (0.2, 0.0), 0.7), 0.6, 0.85, CONFIG)
    assert plane is None or float(np.hypot(*plane.slope)) <= math.tan(CONFIG.tilt) + 1e-9


@pytest.mark.parametrize("count", [0, 30])
def test_nothing_makes_no_plane(count: int) -> None:
    assert find_plane(patch(0, (0.0, 0.0), 0.7)[:count], 0.6, 0.85, CONFIG) is None


def test_a_ledge_is_too_small_to_be_the_surface() -> None:
    points = patch(0, (0.0, 0.0), 0.7) * np.array([0.2, 0.1, 1.0])
    assert find_plane(points, 0.6, 0.85, CONFIG) is None


@pytest.mark.parametrize("roll", [-0.006, 0.005])
@pytest.mark.parametrize("pitch", [-0.005, 0.006])
def test_a_crooked_camera_still_sees_a_level_table(
    viewed: Viewed, roll: float, pitch: float
) -> None:
    """In the optical frame x is right and z ahead: pitch is about x, roll about z."""
    mounting = Transform((0.0, 0.0, 0.0), quaternion_from_rpy(pitch, 0.0, roll))
    post = Round((1.0, 0.2, TOP), 0.2, 0.03)
    views = viewed([TABLE, post], pans=(-0.2, 0.2), mounting=mounting)
    support = measure_support(views, 0.66, 0.78)
    assert support is not None
    on_table = support.points[support.on_plane]
    slope = np.polyfit(on_table[:, 0], on_table[:, 2], 1)[0]
    assert slope == pytest.approx(0.0, abs=0.001)
    assert support.height == pytest.approx(TOP, abs=0.008)
    top = support.points[support.points[:, 2] > support.height + 0.19]
    assert np.median(top[:, 2]) - support.height == pytest.approx(0.2, abs=0.004)


def test_the_outline_holds_what_was_seen(viewed: Viewed) -> None:
    support = measure_support(viewed([TABLE]), 0.66, 0.78)
    assert support is not None
    assert depth_inside(support.points[support.on_plane, :2], support.outline).min() > -1e-5
    assert support.outline[:, 0].min() == pytest.approx(0.7, abs=0.02)
    assert support.outline[:, 0].max() == pytest.approx(1.3, abs=0.03)


def test_views_without_a_surface_are_left_out(viewed: Viewed) -> None:
    both = [*viewed([TABLE]), *viewed([])]
    support = measure_support(both, 0.66, 0.78)
    assert support is not None
    assert len(support.cameras) == 1
    assert measure_support(viewed([]), 0.66, 0.78) is None
    assert measure_support([], 0.66, 0.78) is None

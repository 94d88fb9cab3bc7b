"""Where to look: sweeps show a surface whole, further looks go to either side of a thing."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from momantu_skills.gaze import surveys
from momantu_skills.gaze.surveys import SIDESTEP, beside, sweep
from momantu_skills.perception.geometry.regions import (
    BESIDE,
    HEADROOM,
    HEIGHT_ERROR,
    depth_inside,
    place_region,
    surface_region,
)

from momantu_bt.geometry import Pose2D
from momantu_bt.testing import ScriptedRobot, small_robot

CAMERA = small_robot().camera()[1]
PLACES = st.builds(Pose2D, st.floats(-4, 4), st.floats(-4, 4), st.floats(-3.1, 3.1))
SIZES = st.tuples(st.floats(0.4, 1.0), st.floats(0.6, 2.0))


def corners_of(place: Pose2D, size: tuple[float, float], height: float = 0.7) -> np.ndarray:
    signs = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
    return place.transform(height).apply(signs * (size[0] / 2, size[1] / 2, 0.0))


def seen_from(x: float, y: float, height: float = 1.2) -> np.ndarray:
    """A camera x m before and y m beside the origin, whose looks go towards it."""
    return np.array([-x, y, height])


def bearings(points: np.ndarray, camera: np.ndarray, ahead: float) -> np.ndarray:
    turned = np.arctan2(points[:, 1] - camera[1], points[:, 0] - camera[0]) - ahead
    return np.arctan2(np.sin(turned), np.cos(turned))


@settings(max_examples=60)
@given(PLACES, SIZES, st.floats(1.3, 2.5), st.floats(-0.8, 0.8), st.integers(1, 4))
def test_every_corner_is_in_some_view_and_every_look_on_the_surface(
    place: Pose2D, size: tuple[float, float], away: float, side: float, at_least: int
) -> None:
    corners = corners_of(place, size)
    camera = place.transform().apply(seen_from(away, side))
    looks = np.array(sweep(corners, camera, CAMERA, at_least))
    assert len(looks) >= at_least
    assert depth_inside(looks[:, :2], corners[:, :2]).min() > -1e-9
    assert looks[:, 2] == pytest.approx(np.full(len(looks), 0.7))
    ahead = math.atan2(place.y - camera[1], place.x - camera[0])
    towards = bearings(looks, camera, ahead)
    apart = np.abs(bearings(corners, camera, ahead)[:, None] - towards)
    assert apart.min(axis=1).max() < 0.5 * CAMERA.horizontal_fov
    in_order = np.sort(towards)
    assert (np.diff(in_order) < 0.7 * CAMERA.horizontal_fov + 1e-9).all()
    middle = (in_order[0] + in_order[-1]) / 2
    off = np.abs(towards - middle)
    assert (np.diff(off) > -1e-9).all(), "from the middle outwards"


@settings(max_examples=40)
@given(PLACES, PLACES, SIZES, st.floats(1.3, 2.5), st.floats(-0.8, 0.8))
def test_looks_move_with_the_scene(
    place: Pose2D, frame: Pose2D, size: tuple[float, float], away: float, side: float
) -> None:
    assume(abs(side) > 0.01)
    corners = corners_of(place, size)
    camera = place.transform().apply(seen_from(away, side))
    here = np.array(sweep(corners, camera, CAMERA, 3))
    odom = frame.transform()
    there = np.array(sweep(odom.apply(corners), odom.apply(camera), CAMERA, 3))
    assert len(there) == len(here)
    apart = np.linalg.norm(there[:, None] - odom.apply(here)[None], axis=2)
    assert apart.min(axis=1).max() < 1e-6


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-3, 3), st.floats(-3, 3))
def test_further_looks_go_beside_the_thing_left_and_right_in_turn(
    x: float, y: float, u: float, v: float
) -> None:
    thing, camera = np.array([x, y, 0.8]), np.array([u, v, 1.2])
    assume(math.hypot(x - u, y - v) > 0.3)
    assert (beside(thing, camera, 1) == thing).all()
    looks = [beside(thing, camera, n) - thing for n in (2, 3, 4)]
    for look in looks:
        assert np.linalg.norm(look) == pytest.approx(SIDESTEP)
        assert look @ (thing - camera) == pytest.approx(0.0, abs=1e-9)
    assert looks[0] == pytest.approx(-looks[1], abs=1e-12)
    assert looks[0] == pytest.approx(looks[2], abs=1e-12)


def test_a_thing_right_below_the_camera_can_be_looked_at_again() -> None:
    assert np.isfinite(beside(np.array([1.0, 1.0, 0.7]), np.array([1.0, 1.0, 1.4]), 2)).all()


@given(PLACES, SIZES, st.floats(0.5, 0.9), st.floats(-0.1, 0.1), st.floats(-0.1, 0.1))
def test_a_surface_that_stands_a_little_off_is_inside_its_region(
    place: Pose2D, size: tuple[float, float], height: float, dx: float, dy: float
) -> None:
    region = surface_region(corners_of(place, size, height))
    for dz in (-0.9 * HEIGHT_ERROR, 0.9 * HEIGHT_ERROR):
        moved = corners_of(place @ Pose2D(dx, dy), size, height + dz)
        assert region.contains(moved).all()
        assert region.support_heights[0] < height + dz < region.support_heights[1]
        top = moved + np.array([0.0, 0.0, 0.9 * HEADROOM])
        assert region.contains(top).all()
    beyond = corners_of(place, (size[0] + 3 * BESIDE, size[1] + 3 * BESIDE), height)
    assert not region.contains(beyond).any()


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(0.4, 1.0))
def test_around_a_place_that_was_measured_the_looks_surround_it(
    x: float, y: float, z: float
) -> None:
    near = np.array([x, y, z])
    corners, region = place_region(near)
    assert corners.mean(axis=0) == pytest.approx(near, abs=1e-9)
    assert region.contains(corners).all()
    assert depth_inside(near[None, :2], corners[:, :2])[0] > 0.0
    assert region.support_heights[0] < z < region.support_heights[1]
    assert not region.contains(near[None] - np.array([0.0, 0.0, 0.1])).any()


def test_a_fixed_camera_looks_at_all_that_is_in_its_picture() -> None:
    camera = small_robot().camera()[1]
    half = math.atan(math.tan(camera.horizontal_fov / 2) * camera.height / camera.width)
    fixed = camera.model_copy(update={"carrier": None})
    robot = small_robot().model_copy(update={"sensors": {"camera": fixed}})
    assert surveys._off_axis(ScriptedRobot(robot)) == pytest.approx(half)
    assert surveys._off_axis(ScriptedRobot()) == surveys.OFF_AXIS

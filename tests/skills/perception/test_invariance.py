"""Moving the whole scene moves what is measured, and nothing else about it changes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.perception.camera.cloud import points_from_depth
from momantu_skills.perception.geometry.grids import Grid
from momantu_skills.perception.geometry.rectangles import smallest_rectangle
from momantu_skills.perception.objects.splitting import _circumcircles, split
from momantu_skills.perception.surface.segment import SegmentConfig, Thing, group
from momantu_skills.perception.surface.spots import Ground, SpotConfig, free_spots
from momantu_skills.perception.tags.single import TagSighting, average

from momantu_bt.geometry import Pose2D, Transform

SEEDS = st.integers(0, 10_000)
PLACES = st.builds(Pose2D, st.floats(-4, 4), st.floats(-4, 4), st.floats(-3.1, 3.1))


def moved(place: Pose2D, points: np.ndarray) -> np.ndarray:
    """Points (n, 2) or (n, 3), placed."""
    full = np.column_stack([points, np.zeros(len(points))]) if points.shape[1] == 2 else points
    return place.transform().apply(full)[:, : points.shape[1]]


def can_sides(centre: tuple[float, float], radius: float, seed: int) -> np.ndarray:
    """Points of a can's side, seen from below x, and of its top."""
    random = np.random.default_rng(seed)
    angles = math.pi + random.uniform(-1.3, 1.3, 500)
    ring = np.column_stack([np.cos(angles), np.sin(angles)]) * radius + centre
    return np.column_stack([ring, random.uniform(0.015, 0.11, 500)])


@settings(max_examples=30)
@given(SEEDS, PLACES)
def test_the_smallest_rectangle_turns_with_its_points(seed: int, place: Pose2D) -> None:
    points = np.random.default_rng(seed).uniform(-0.5, 0.5, (600, 2)) * (0.2, 0.11)
    here, there = smallest_rectangle(points), smallest_rectangle(moved(place, points))
    assert there.centre == pytest.approx(moved(place, here.centre[None])[0], abs=0.003)
    assert sorted(there.size) == pytest.approx(sorted(here.size), abs=0.003)
    assert there.size.prod() < 1.02 * 0.2 * 0.11
    asked = np.random.default_rng(seed + 1).uniform(-0.3, 0.3, (50, 2))
    far = here.distances(asked) - there.distances(moved(place, asked))
    assert np.abs(far).max() < 0.006


@given(SEEDS, st.floats(0.01, 0.2))
def test_three_points_of_a_circle_give_it_back(seed: int, radius: float) -> None:
    random = np.random.default_rng(seed)
    centre = random.uniform(-2, 2, 2)
    turns = random.uniform(0, 2 * math.pi, 40)[:, None] + (0.0, 0.9, 2.5)
    a, b, c = (
        centre + radius * np.column_stack([np.cos(turns[:, k]), np.sin(turns[:, k])])
        for k in range(3)
    )
    centres, radii = _circumcircles(a, b, c)
    assert centres == pytest.approx(np.tile(centre, (40, 1)), abs=1e-8)
    assert radii == pytest.approx(np.full(40, radius), rel=1e-6)


def test_three_points_in_line_are_on_no_circle() -> None:
    a, b, c = (np.array([[0.1 * k, 0.2 * k], [1.0, 1.0]]) for k in range(3))
    assert np.isinf(_circumcircles(a, b, c)[1]).all()


@settings(max_examples=12)
@given(SEEDS, PLACES)
def test_two_cans_that_touch_are_two_wherever_they_stand(seed: int, place: Pose2D) -> None:
    cans = [can_sides((0.0, y), 0.033, seed + n) for n, y in enumerate((-0.034, 0.034))]
    points = moved(place, np.vstack(cans))
    thing = Thing(points, np.ones(len(points), dtype=bool))
    parts = split(thing, SegmentConfig())
    assert len(parts) == 2
    middles = moved(place, np.array([(0.0, -0.034), (0.0, 0.034)]))
    for part in parts:
        away = np.linalg.norm(part.points[:, None, :2] - middles[None], axis=2)
        assert (away < 0.045).mean(axis=0).max() > 0.97
    assert sum(len(part.points) for part in parts) > 0.9 * len(points)


@settings(max_examples=30)
@given(SEEDS, st.integers(1, 4), st.permutations(range(4)))
def test_things_do_not_depend_on_the_order_of_points(
    seed: int, count: int, order: list[int]
) -> None:
    cans = [can_sides((0.0, 0.15 * order[n]), 0.033, seed + n) for n in range(count)]
    points = np.vstack(cans)
    shuffled = np.random.default_rng(seed).permutation(points)
    sorted_sets = [
        sorted(
            tuple(sorted(map(tuple, thing.points.round(9))))
            for thing in group(some, SegmentConfig())
        )
        for some in (points, shuffled)
    ]
    assert len(sorted_sets[0]) == count
    assert sorted_sets[0] == sorted_sets[1]


@settings(max_examples=20)
@given(SEEDS, st.floats(-3, 3), st.floats(-3, 3))
def test_spots_move_with_the_table(seed: int, x: float, y: float) -> None:
    config, outline = SpotConfig(), np.array([[0.0, 0.0], [0.6, 0.0], [0.6, 1.0], [0.0, 1.0]])
    shift = np.round(np.array([x, y]) / config.cell) * config.cell
    grid = Grid(np.array([-0.05, -0.05]), config.cell, (70, 110))
    things = np.random.default_rng(seed).uniform((0.05, 0.05), (0.55, 0.95), (3, 2))
    near = np.linalg.norm(grid.centres()[:, :, None] - things, axis=3).min(axis=2) < 0.03
    inside = ((grid.centres() > 0.0) & (grid.centres() < (0.6, 1.0))).all(axis=2)
    found = []
    for by in (np.zeros(2), shift):
        ground = Ground(Grid(grid.origin + by, grid.cell, grid.shape), near, inside & ~near)
        asked, robot = np.array([0.31, 0.52]) + by, np.array([-0.5, 0.43]) + by
        spots = free_spots(ground, outline + by, asked, robot, 0.0351, config)
        found.append(np.array(spots).reshape(-1, 2) - by)
    assert len(found[0]) == len(found[1])
    if len(found[0]):
        assert found[1][0] == pytest.approx(found[0][0], abs=2 * config.cell)


@settings(max_examples=30)
@given(SEEDS, PLACES)
def test_the_average_of_sightings_moves_with_them_and_has_no_order(
    seed: int, place: Pose2D
) -> None:
    random = np.random.default_rng(seed)
    truth = place.transform(0.7)
    sightings = []
    for n in range(5):
        turn = np.array([1.0, *(0.02 * random.normal(size=3))]) * random.choice([-1.0, 1.0])
        error = Transform(0.003 * random.normal(size=3), turn)
        sightings.append(
            TagSighting(error, float(random.uniform(0.001, 0.01)), float(n), np.eye(6))
        )
    here = average(sightings)
    there = average(
        [TagSighting(truth @ s.odom_from_tag, s.sigma, s.stamp, np.eye(6)) for s in sightings]
    )
    expected = truth @ here.odom_from_tag
    assert there.odom_from_tag.position == pytest.approx(expected.position, abs=1e-9)
    assert there.odom_from_tag.angle_to(expected) < 1e-5
    assert there.sigma == pytest.approx(here.sigma)
    other_way = average([*sightings[:4][::-1], sightings[4]])
    assert other_way.odom_from_tag.angle_to(here.odom_from_tag) < 1e-5
    assert other_way.sigma == pytest.approx(here.sigma)


@settings(max_examples=30)
@given(SEEDS, st.floats(0.5, 3.0))
def test_a_flat_wall_is_a_plane_of_points(seed: int, distance: float) -> None:
    intrinsics = np.array([[100.0, 0.0, 31.5], [0.0, 90.0, 23.5], [0.0, 0.0, 1.0]])
    normal = np.array([*np.random.default_rng(seed).uniform(-0.3, 0.3, 2), 1.0])
    v, u = np.mgrid[0:48, 0:64]
    rays = np.stack([(u - 31.5) / 100.0, (v - 23.5) / 90.0, np.ones(u.shape)], axis=-1)
    depth = (distance / (rays @ normal)).astype(np.float32)
    points = points_from_depth(depth, intrinsics)
    assert len(points) > 0.95 * depth.size
    assert points @ normal == pytest.approx(np.full(len(points), distance), rel=1e-5)

"""Cells and supports: the same from whichever side, in whichever order, wherever odom lies."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.manipulation.config import SceneConfig
from momantu_skills.manipulation.scene.surroundings import (
    BOARD_DEPTH,
    EDGE,
    SUPPORT_DEPTH,
    Support,
    Surroundings,
    cells_of,
    faces_of,
    known_support,
    merged,
    same_surface,
    shelved,
    support_around,
    within,
)
from scipy.spatial import ConvexHull

from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.world import Surface

CONFIG = SceneConfig()
SEEDS = st.integers(0, 10_000)
PLACES = st.builds(Pose2D, st.floats(-4, 4), st.floats(-4, 4), st.floats(-3.1, 3.1))


def cloud(seed: int, count: int = 400) -> np.ndarray:
    return np.random.default_rng(seed).uniform((0.5, -0.4, 0.0), (1.2, 0.4, 1.2), (count, 3))


def patch(place: Pose2D, size: tuple[float, float], z: float, step: float = 0.02) -> np.ndarray:
    xs, ys = (np.arange(-edge / 2, edge / 2 + 1e-9, step) for edge in size)
    flat = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)
    return place.transform().apply(np.column_stack([flat, np.full(len(flat), z)]))


def outline_of(place: Pose2D, size: tuple[float, float]) -> np.ndarray:
    signs = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
    return place.transform().apply(signs * (size[0] / 2, size[1] / 2, 0.0))[:, :2]


@settings(max_examples=30)
@given(SEEDS)
def test_cells_do_not_depend_on_the_order_of_points(seed: int) -> None:
    points = np.repeat(cloud(seed), 2, axis=0)
    shuffled = np.random.default_rng(seed).permutation(points)
    eye = np.array([0.0, 0.0, 1.4])
    found = cells_of(points, eye, 0.06, CONFIG)
    assert np.array_equal(found, cells_of(shuffled, eye, 0.06, CONFIG))
    assert len(np.unique(found, axis=0)) == len(found)


@settings(max_examples=30)
@given(SEEDS, st.floats(-0.2, 0.4), st.floats(-0.4, 0.4))
def test_every_seen_cell_is_filled_and_none_before_it(seed: int, x: float, y: float) -> None:
    points = np.repeat(cloud(seed, 30), 2, axis=0)
    eye = np.array([x, y, 1.4])
    cells = cells_of(points, eye, 0.06, CONFIG)
    seen = points[points[:, 2] > 0.06]
    apart = np.abs(seen[:, None] - cells[None]).max(axis=2)
    assert (apart.min(axis=1) <= CONFIG.voxel / 2 + 1e-9).all()
    reach = CONFIG.thickness + 1.5 * CONFIG.voxel
    for cell in cells:
        near = seen[np.abs(seen[:, 2] - cell[2]) <= CONFIG.voxel / 2 + 1e-9]
        gaps = np.linalg.norm(near[:, :2] - cell[:2], axis=1)
        assert gaps.min() <= reach
        closer = np.linalg.norm(near[gaps <= reach, :2] - eye[:2], axis=1).min()
        assert np.linalg.norm(cell[:2] - eye[:2]) >= closer - 1.5 * CONFIG.voxel


@settings(max_examples=10)
@given(SEEDS, st.integers(-50, 50), st.integers(-50, 50), st.integers(0, 20))
def test_cells_move_with_whole_cells(seed: int, a: int, b: int, c: int) -> None:
    points = np.floor(np.repeat(cloud(seed), 2, axis=0) / CONFIG.voxel + 0.5) * CONFIG.voxel
    points += 0.3 * CONFIG.voxel
    eye = np.array([0.0031, 0.0017, 1.4])
    shift = CONFIG.voxel * np.array([a, b, c])
    here = cells_of(points, eye, 0.06, CONFIG)
    there = cells_of(points + shift, eye + shift, 0.06 + shift[2], CONFIG)
    assert len(there) == pytest.approx(len(here), rel=0.02)
    apart = np.abs((there - shift)[:, None] - here[None]).max(axis=2).min(axis=1)
    assert (apart < 1e-6).mean() > 0.98


@given(SEEDS, PLACES, st.tuples(*[st.floats(0.02, 0.4)] * 3))
def test_a_box_takes_out_the_cells_whose_middle_is_in_it(
    seed: int, place: Pose2D, half: tuple[float, float, float]
) -> None:
    pose = place.transform(0.5)
    local = np.random.default_rng(seed).uniform(-0.6, 0.6, (200, 3))
    local = local[(np.abs(np.abs(local) - half) > 1e-9).all(axis=1)]
    around = Surroundings(pose.apply(local), (), 3.0)
    left = around.without(pose, half)
    outside = (np.abs(local) > half).any(axis=1)
    assert np.array_equal(left.cells, around.cells[outside])
    assert left.stamp == 3.0


BOX, GROWN = (0.07, 0.11, 0.14), (0.06, 0.08, 0.10)
"""A box, m, and half of it with the margin that a grasp ignores around it."""


def seen_from(eye: np.ndarray, pose: Transform, size: tuple[float, float, float]) -> Surroundings:
    """What remains of the faces of a box that a camera sees."""
    half = np.array(size) / 2
    steps = [np.arange(-h, h + 1e-9, 0.004) for h in half]
    local = np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 3)
    toward = pose.inverse().apply(eye)
    sides = [
        local[np.abs(local[:, k] - math.copysign(steps[k].max(), toward[k])) < 0.002]
        for k in range(3)
        if abs(toward[k]) > half[k]
    ]
    points = pose.apply(np.vstack(sides))
    cells, faces = cells_of(points, eye, 0.06, CONFIG), faces_of(points, 0.06, CONFIG)
    return Surroundings(cells, (), 0.0, faces, CONFIG.thickness + CONFIG.voxel)


@pytest.mark.parametrize("degrees", range(0, 180, 15))
def test_nothing_remains_of_a_box_that_is_seen_over_its_corner(degrees: int) -> None:
    pose = Pose2D(0.8, 0.1, math.radians(degrees)).transform(0.8)
    around = seen_from(np.array([0.0, 0.0, 1.1]), pose, BOX)
    assert len(around.without(pose, GROWN, filled=True).cells) == 0
    # without the faces, what is assumed behind its edges lies beside it
    assert len(replace(around, faces=None).without(pose, (0.04, 0.06, 0.08), filled=True).cells) > 0


@given(st.floats(0.09, 0.3), st.floats(-1.5, 1.5))
def test_a_neighbour_and_what_may_be_behind_it_remain(away: float, turn: float) -> None:
    pose = Pose2D(0.8, 0.1, turn).transform(0.8)
    eye = np.array([0.0, 0.0, 1.1])
    other = pose @ Transform((0.0, GROWN[1] + away, 0.0))
    alone, near = seen_from(eye, pose, BOX), seen_from(eye, other, (0.05, 0.05, 0.14))
    faces = np.vstack([alone.faces, near.faces])  # type: ignore[list-item]
    both = replace(alone, cells=np.vstack([alone.cells, near.cells]), faces=faces)
    left = both.without(pose, GROWN, filled=True).cells
    outside = near.without(pose, GROWN, filled=True).cells
    assert {tuple(cell) for cell in outside} <= {tuple(cell) for cell in left}


@settings(max_examples=40)
@given(PLACES, st.floats(0.3, 0.8), st.floats(0.4, 1.5), st.floats(0.4, 0.9))
def test_a_support_is_found_wherever_it_stands(
    place: Pose2D, x: float, y: float, height: float
) -> None:
    points = patch(place, (x, y), height + 0.004)
    noise = np.random.default_rng(0).uniform(-2, 2, (300, 3)) + np.array([place.x, place.y, 3.0])
    found = support_around(
        np.vstack([points, noise]), np.array([place.x, place.y]), height, CONFIG.surface_band
    )
    assert found is not None
    assert found.height == height
    assert ConvexHull(found.outline).volume == pytest.approx(x * y, rel=0.15)
    assert within(points[:, :2], found.outline, 1e-6).all()
    assert found.outline.mean(axis=0) == pytest.approx((place.x, place.y), abs=0.05)


@pytest.mark.parametrize("off", [-0.03, -0.016, 0.016, 0.03])
def test_a_surface_at_another_height_is_not_the_support(off: float) -> None:
    points = patch(Pose2D(1.0, 0.0), (0.5, 0.5), 0.72 + off)
    assert support_around(points, np.array([1.0, 0.0]), 0.72, CONFIG.surface_band) is None


def test_points_in_one_line_are_no_surface() -> None:
    line = np.column_stack([np.linspace(0, 1, 200), np.zeros(200), np.full(200, 0.7)])
    assert support_around(line, np.zeros(2), 0.7, CONFIG.surface_band) is None


@settings(max_examples=40)
@given(SEEDS, PLACES, st.floats(-0.1, 0.3))
def test_within_agrees_with_the_hulls_planes(seed: int, place: Pose2D, margin: float) -> None:
    random = np.random.default_rng(seed)
    corners = random.uniform(-0.5, 0.5, (12, 2))
    outline = corners[ConvexHull(corners).vertices]
    points = random.uniform(-1, 1, (200, 2))
    planes = ConvexHull(corners).equations
    outside = (points @ planes[:, :2].T + planes[:, 2]).max(axis=1)
    sure = np.abs(outside - margin) > 1e-9
    assert (within(points, outline, margin) == (outside <= margin))[sure].all()
    pose = place.transform()

    def moved(flat: np.ndarray) -> np.ndarray:
        return pose.apply(np.column_stack([flat, np.zeros(len(flat))]))[:, :2]

    assert (within(moved(points), moved(outline), margin) == (outside <= margin))[sure].all()


@given(PLACES, PLACES, st.floats(0.5, 0.9))
def test_the_solid_of_a_support_lies_below_its_top_and_around_its_outline(
    place: Pose2D, base: Pose2D, height: float
) -> None:
    support = Support(outline_of(place, (0.6, 1.2)), height)
    solid = support.obstacle(base.transform().inverse(), "top")
    corners = base.transform().apply(solid.corners)
    assert solid.name == "top"
    assert solid.support
    assert corners[:, 2].max() == pytest.approx(height)
    assert corners[:, 2].min() == pytest.approx(height - SUPPORT_DEPTH)
    wide = corners[:, :2][ConvexHull(corners[:, :2]).vertices]
    assert within(support.outline, wide, -0.9 * EDGE).all()
    assert within(wide, support.outline, EDGE + 1e-9).all()


@given(PLACES, PLACES, st.floats(0.4, 1.0), st.floats(0.6, 1.6), st.floats(0.5, 0.9))
def test_what_the_site_knows_is_placed_by_localization(
    odom_from_map: Pose2D, place: Pose2D, x: float, y: float, height: float
) -> None:
    surface = Surface(place, (x, y), height, (math.pi,))
    known = known_support(surface, odom_from_map.transform())
    assert known.outline == pytest.approx(outline_of(odom_from_map @ place, (x, y)), abs=1e-9)
    assert known.height >= height
    middle = known.outline.mean(axis=0)
    assert within(middle[None], known.outline)[0], "the outline must be counter-clockwise"


@settings(max_examples=40)
@given(PLACES, st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.floats(-0.03, 0.03))
def test_a_table_within_its_tolerance_is_the_known_one(
    place: Pose2D, dx: float, dy: float, dz: float
) -> None:
    known = known_support(Surface(place, (0.8, 1.6), 0.7, (math.pi,)), Transform())
    seen = Support(outline_of(place @ Pose2D(dx, dy), (0.8, 1.6)), 0.7 + dz)
    assert same_surface(seen, known)
    whole = merged(seen, known)
    assert within(np.vstack([seen.outline, known.outline]), whole.outline, 1e-9).all()
    assert whole.height == seen.height


@given(PLACES, st.sampled_from([0.12, -0.12]))
def test_a_shelf_above_or_below_is_not(place: Pose2D, dz: float) -> None:
    known = known_support(Surface(place, (0.8, 1.6), 0.7, (math.pi,)), Transform())
    assert not same_surface(Support(outline_of(place, (0.8, 1.6)), 0.7 + dz), known)


def test_only_what_hangs_over_another_surface_is_a_board() -> None:
    below = Support(outline_of(Pose2D(0.0, 0.0, 0.0), (0.6, 1.2)), 0.6)
    above = Support(outline_of(Pose2D(0.05, 0.3, 0.0), (0.5, 0.5)), 1.1)
    beside = Support(outline_of(Pose2D(2.0, 0.0, 0.0), (0.6, 1.2)), 1.1)
    badly_seen = Support(outline_of(Pose2D(0.0, 0.0, 0.0), (0.6, 1.2)), 0.7)
    assert [s.board for s in shelved((below, above, beside))] == [False, True, False]
    assert [s.board for s in shelved((above, below))] == [True, False]
    assert not any(s.board for s in shelved((below, badly_seen)))


def test_under_a_board_there_is_room_for_an_arm() -> None:
    outline = outline_of(Pose2D(0.0, 0.0, 0.0), (0.6, 1.2))
    _, board = shelved((Support(outline, 0.6), Support(outline, 1.1)))
    corners = board.obstacle(Transform(), "board").corners
    assert corners[:, 2].max() == pytest.approx(1.1)
    assert corners[:, 2].min() == pytest.approx(1.1 - BOARD_DEPTH)

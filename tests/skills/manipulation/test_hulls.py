"""Hulls and masks against scipy and exact boxes: nothing of the body sticks out of them."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.manipulation.model.arm_model import ArmModel
from momantu_skills.manipulation.model.hulls import (
    MOST_CORNERS,
    LinkMask,
    convex,
    floor_outline,
    hull_points,
    link_hulls,
    load_mesh,
    object_corners,
    part_points,
    prism,
)
from momantu_skills.manipulation.model.urdf import CollisionPart, base_urdf
from momantu_worlds.robots import fetch
from scipy.spatial import ConvexHull

from momantu_bt.geometry import Pose, Transform
from momantu_bt.messages import DetectedObject

SEEDS = st.integers(0, 10_000)
POSES = st.builds(
    lambda seed: Transform(
        np.random.default_rng(seed).uniform(-1, 1, 3), np.random.default_rng(seed).normal(size=4)
    ),
    SEEDS,
)


def depth(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(n,) how deep points lie inside the hull of corners; negative outside, m."""
    planes = ConvexHull(corners).equations
    return -(points @ planes[:, :3].T + planes[:, 3]).max(axis=1)


def part(kind: str, size: tuple[float, float, float], pose: Transform) -> CollisionPart:
    return CollisionPart("link", kind, pose, size)


@settings(max_examples=40)
@given(SEEDS, st.integers(5, 400))
def test_a_thinned_hull_lies_within_and_reaches_as_far(seed: int, count: int) -> None:
    points = np.random.default_rng(seed).normal(size=(count, 3)) * (0.1, 0.05, 0.2)
    corners = hull_points(points)
    assert len(corners) <= MOST_CORNERS + 6
    assert {tuple(c) for c in corners} <= {tuple(p) for p in points}
    assert corners.min(axis=0) == pytest.approx(points.min(axis=0))
    assert corners.max(axis=0) == pytest.approx(points.max(axis=0))
    if len(ConvexHull(points).vertices) <= MOST_CORNERS:
        assert depth(points, corners).min() > -1e-9


@pytest.mark.parametrize(
    ("links", "shrink"), [("gripper wrist_roll", 0.003), ("shoulder upperarm elbow forearm", 0.007)]
)
def test_hulls_of_the_arm_lose_little_of_their_meshes(links: str, shrink: float) -> None:
    names = tuple(links.split())
    parts = [p for p in base_urdf(fetch()).parts if p.link.startswith(names)]
    hulls = link_hulls(parts)
    for each in parts:
        vertices = each.link_from_part.apply(np.asarray(load_mesh(each).vertices()))
        assert depth(vertices, hulls[each.link]).min() > -shrink, each.link
    assert len(hulls) >= 2


@given(POSES, SEEDS, st.floats(0.02, 0.3), st.floats(0.02, 0.5))
def test_a_cylinders_prism_covers_it_and_hardly_more(
    pose: Transform, seed: int, radius: float, height: float
) -> None:
    corners = part_points(part("cylinder", (radius, height, 0.0), pose))
    random = np.random.default_rng(seed)
    angles, z = random.uniform(-np.pi, np.pi, 200), random.choice([-height / 2, height / 2], 200)
    rim = pose.apply(np.column_stack([radius * np.cos(angles), radius * np.sin(angles), z]))
    assert depth(rim, corners).min() > -1e-9
    local = pose.inverse().apply(corners)
    assert np.hypot(local[:, 0], local[:, 1]).max() < 1.03 * radius
    assert np.abs(local[:, 2]).max() == pytest.approx(height / 2)


@given(POSES, SEEDS, st.floats(0.02, 0.3))
def test_a_spheres_hull_covers_it_and_hardly_more(
    pose: Transform, seed: int, radius: float
) -> None:
    corners = part_points(part("sphere", (radius, 0.0, 0.0), pose))
    ways = np.random.default_rng(seed).normal(size=(200, 3))
    surface = pose.apply(radius * ways / np.linalg.norm(ways, axis=1, keepdims=True))
    assert depth(surface, corners).min() > -1e-9
    assert np.linalg.norm(corners - pose.position, axis=1).max() < 1.1 * radius


@given(POSES, st.tuples(*[st.floats(0.02, 0.5)] * 3))
def test_a_box_is_its_eight_corners(pose: Transform, size: tuple[float, float, float]) -> None:
    corners = part_points(part("box", size, pose))
    assert len(corners) == 8
    local = pose.inverse().apply(corners)
    assert np.abs(local) == pytest.approx(np.tile(np.array(size) / 2, (8, 1)))
    assert len(np.unique(np.round(np.sign(local)), axis=0)) == 8


def test_parts_of_one_link_share_a_hull() -> None:
    left = part("box", (0.1, 0.1, 0.1), Transform((0.0, 0.3, 0.0)))
    right = part("box", (0.1, 0.1, 0.1), Transform((0.0, -0.3, 0.0)))
    other = CollisionPart("other", "box", Transform(), (0.1, 0.1, 0.1))
    hulls = link_hulls([left, other, right])
    assert set(hulls) == {"link", "other"}
    assert np.ptp(hulls["link"], axis=0) == pytest.approx((0.1, 0.7, 0.1))


@settings(max_examples=30)
@given(SEEDS, POSES)
def test_shapes_have_the_volume_and_the_middle_of_the_hull(seed: int, pose: Transform) -> None:
    points = pose.apply(np.random.default_rng(seed).normal(size=(25, 3)) * 0.1)
    shape, hull = convex(points), ConvexHull(points)
    assert shape.num_points == len(hull.vertices)
    assert shape.computeVolume() == pytest.approx(hull.volume, rel=1e-6)
    assert depth(np.asarray(shape.computeCOM())[None], points)[0] > 0.0


@settings(max_examples=40)
@given(SEEDS, POSES, st.floats(0.0, 0.05))
def test_the_mask_covers_all_that_is_within_the_padding_of_a_hull(
    seed: int, pose: Transform, padding: float
) -> None:
    random = np.random.default_rng(seed)
    hull = random.uniform(-0.1, 0.1, (20, 3)) + random.uniform(-0.2, 0.2, 3)
    inside = random.dirichlet(np.ones(20), 200) @ hull
    ways = random.normal(size=(200, 3))
    ways *= 0.999 * padding / np.linalg.norm(ways, axis=1, keepdims=True)
    points = pose.apply(inside + ways)
    assert LinkMask({"a": hull}, padding).covers(points, {"a": pose.matrix}).all()


@settings(max_examples=40)
@given(SEEDS, POSES, st.tuples(*[st.floats(0.02, 0.3)] * 3), st.floats(0.0, 0.05))
def test_of_a_box_the_mask_covers_no_more_than_the_padded_box(
    seed: int, pose: Transform, size: tuple[float, float, float], padding: float
) -> None:
    half = np.array(size) / 2
    corners = np.array(list(product((-1, 1), repeat=3))) * half
    local = np.random.default_rng(seed).uniform(-1.6, 1.6, (400, 3)) * (half + padding)
    found = LinkMask({"a": corners}, padding).covers(pose.apply(local), {"a": pose.matrix})
    beyond = np.maximum(np.abs(local) - half, 0.0)
    assert found[np.linalg.norm(beyond, axis=1) < padding - 1e-9].all()
    assert not found[(beyond > padding + 1e-9).any(axis=1)].any()


def test_masks_of_several_links_are_those_of_each() -> None:
    random = np.random.default_rng(2)
    hulls = {name: random.normal(size=(12, 3)) * 0.1 for name in "abc"}
    poses = {
        n: Transform(random.uniform(-0.3, 0.3, 3), random.normal(size=4)).matrix for n in hulls
    }
    points = random.uniform(-0.6, 0.6, (3000, 3))
    whole = LinkMask(hulls, 0.02).covers(points, poses)
    each = [LinkMask({n: h}, 0.02).covers(points, poses) for n, h in hulls.items()]
    assert (whole == np.any(each, axis=0)).all()
    assert 0 < whole.sum() < len(points)


def test_a_sweep_of_postures_is_masked_by_its_own_hulls_only(model: ArmModel) -> None:
    random = np.random.default_rng(5)
    mask = LinkMask(model.hulls, 0.0)
    lower = np.maximum(model.pin.lowerPositionLimit, -np.pi)
    upper = np.minimum(model.pin.upperPositionLimit, np.pi)
    for _ in range(4):
        poses = model.link_poses(random.uniform(lower, upper))
        points = random.uniform((-0.5, -0.8, 0.0), (1.2, 0.8, 1.8), (4000, 3))
        found = mask.covers(points, poses)
        inside = np.zeros(len(points), dtype=bool)
        for name, hull in model.hulls.items():
            pose = poses[name]
            inside |= depth(points, hull @ pose[:3, :3].T + pose[:3, 3]) > 0.0
        assert found[inside].all()
        assert inside.sum() > 50
        assert found.sum() < 1.6 * inside.sum()


@given(SEEDS)
def test_an_outline_turns_with_the_corners(seed: int) -> None:
    corners = np.random.default_rng(seed).normal(size=(30, 3))
    turn = Transform((1.0, 2.0, 0.0), (np.cos(0.4), 0.0, 0.0, np.sin(0.4)))
    here, there = floor_outline(corners), floor_outline(turn.apply(corners))
    expected = turn.apply(np.column_stack([here, np.zeros(len(here))]))[:, :2]
    start = int(np.argmin(np.linalg.norm(there - expected[0], axis=1)))
    assert np.roll(there, -start, axis=0) == pytest.approx(expected, abs=1e-9)


@given(st.tuples(*[st.floats(0.02, 0.3)] * 3), st.floats(0.0, 0.03), st.booleans())
def test_an_objects_corners_grow_by_the_padding_on_every_side(
    size: tuple[float, float, float], padding: float, round_one: bool
) -> None:
    size = (size[0], size[0], size[2]) if round_one else size
    shape = "cylinder" if round_one else "box"
    thing = DetectedObject("x", Pose(Transform(), "odom", 0.0), size, shape, 1.0, 0.0)
    extent = np.ptp(object_corners(thing, padding), axis=0)
    slack = 1.02 if round_one else 1.0 + 1e-9
    assert (extent >= np.array(size) + 2 * padding - 1e-9).all()
    assert (extent <= slack * (np.array(size) + 2 * padding)).all()


def test_a_prism_is_symmetric() -> None:
    corners = prism(0.1, 0.3)
    for mirror in ((-1, 1, 1), (1, -1, 1), (1, 1, -1)):
        apart = np.linalg.norm(corners[:, None] * mirror - corners[None], axis=2)
        assert apart.min(axis=1).max() < 1e-12

"""How deep convex solids overlap and where rays meet them, against what is known of them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_worlds.scenes.geometry.bodies import Box, Cylinder, Hull, Part
from momantu_worlds.scenes.geometry.convex import Convex, convex

from momantu_bt.geometry import Transform

SHAPES = (
    Box((0.4, 0.6, 0.2)),
    Cylinder(0.2, 0.5),
    Hull(np.array([(0, 0, 0), (0.5, 0, 0), (0, 0.5, 0), (0, 0, 0.5), (0.4, 0.4, 0.3)])),
)
lengths = st.floats(-1.0, 1.0)
poses = st.builds(
    lambda xyz, rpy: Transform.from_rpy(xyz, rpy),
    st.tuples(lengths, lengths, lengths),
    st.tuples(*[st.floats(-math.pi, math.pi)] * 3),
)
solids = st.builds(lambda shape, pose: convex(Part(shape), pose), st.sampled_from(SHAPES), poses)


def moved(solid: Convex, by: np.ndarray) -> Convex:
    return Convex(solid.vertices + by, solid.normals, solid.edges)


@given(solids, solids)
def test_depth_is_the_same_both_ways_and_is_overlap(a: Convex, b: Convex) -> None:
    depth = a.depth(b)
    assert depth == pytest.approx(b.depth(a), abs=1e-9)
    for first, second in ((a, b), (b, a)):
        deep = (second.vertices @ first.normals.T - first.offsets).max(axis=1) < -1e-3
        assert depth > 0 or not deep.any()


@given(solids, solids, st.floats(0, math.tau), st.floats(-1, 1))
def test_no_way_out_is_shorter_than_the_depth(a: Convex, b: Convex, turn: float, up: float) -> None:
    depth = a.depth(b)
    flat = math.sqrt(1 - up * up)
    way = np.array([flat * math.cos(turn), flat * math.sin(turn), up])
    if depth > 0.01:
        assert moved(a, 0.98 * (depth - 0.005) * way).depth(b) > 0


@given(poses, lengths, lengths, lengths)
def test_boxes_that_are_turned_alike(pose: Transform, x: float, y: float, z: float) -> None:
    first = convex(Part(Box((1.0, 1.0, 1.0))), pose)
    second = convex(Part(Box((1.0, 1.0, 1.0))), pose @ Transform((x, y, z)))
    expected = max(0.0, 1.0 - max(abs(x), abs(y), abs(z)))
    assert first.depth(second) == pytest.approx(expected, abs=1e-6)


def test_edges_that_cross_are_apart_although_no_face_separates_them() -> None:
    half = math.sqrt(0.5)
    first = convex(Part(Box((1, 1, 1))), Transform.from_rpy((0, 0, 0), (math.pi / 4, 0, 0)))
    apart = Transform.from_rpy((0, 0, 2 * half + 0.01), (0, math.pi / 4, 0))
    within = Transform.from_rpy((0, 0, 2 * half - 0.01), (0, math.pi / 4, 0))
    assert first.depth(convex(Part(Box((1, 1, 1))), apart)) == 0.0
    assert first.depth(convex(Part(Box((1, 1, 1))), within)) == pytest.approx(0.01, abs=1e-6)


@given(solids, st.tuples(lengths, lengths, lengths), st.tuples(lengths, lengths, lengths))
def test_a_ray_enters_where_it_is_inside_from(
    solid: Convex, start: tuple[float, ...], way: tuple[float, ...]
) -> None:
    ray = np.array([way])
    if np.linalg.norm(ray) < 0.05:
        return
    at = float(solid.hits(np.array([start]), ray)[0])
    steps = np.linspace(0.0, 4.0, 400)
    points = np.array(start) + steps[:, None] * ray
    inside = (points @ solid.normals.T < solid.offsets - 1e-6).all(axis=1)
    if np.isinf(at):
        assert not inside.any()
    else:
        assert not inside[steps < at - 1e-6].any()
        entered = np.array([start]) + at * ray
        assert (entered @ solid.normals.T - solid.offsets).max() < 1e-6

"""Meshes of parts are those of trimesh, number by number; rays and pictures depend on each."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import assume, given
from hypothesis import strategies as st
from momantu_worlds.sapien.build.meshes import CYLINDER_SIDES, body_mesh, collision_mesh
from momantu_worlds.scenes.geometry.bodies import Body, Box, Cylinder, Geometry, Hull, Part, Sphere

from momantu_bt.geometry import Array, Transform

LENGTH = st.floats(0.001, 5.0)
ANGLE = st.floats(-4.0, 4.0)


def same(geometry: Geometry, expected: trimesh.Trimesh) -> None:
    assert np.array_equal(collision_mesh(geometry).triangles, np.asarray(expected.triangles))


@given(LENGTH, LENGTH, LENGTH)
def test_boxes(x: float, y: float, z: float) -> None:
    same(Box((x, y, z)), trimesh.creation.box(extents=(x, y, z)))


@given(st.floats(1e-6, 5.0), st.floats(1e-6, 5.0))
def test_cylinders(radius: float, height: float) -> None:
    assume(abs(radius * height - 1e-7) > 1e-8)
    expected = trimesh.creation.cylinder(radius=radius, height=height, sections=CYLINDER_SIDES)
    assume(len(expected.vertices) == 2 * CYLINDER_SIDES + 2)  # trimesh merges points that are near
    same(Cylinder(radius, height), expected)


def test_balls() -> None:
    same(Sphere(0.3), trimesh.creation.icosphere(subdivisions=2, radius=0.3))


@given(
    st.integers(0, 10_000),
    st.integers(4, 60),
    st.sampled_from([1, 2, 6]),
    st.tuples(LENGTH, LENGTH, LENGTH),
)
def test_hulls(seed: int, count: int, digits: int, size: tuple[float, float, float]) -> None:
    points = np.random.default_rng(seed).normal(size=(count, 3)).round(digits) * size
    assume(np.linalg.matrix_rank(points - points[0], tol=1e-3) == 3)
    same(Hull(points), trimesh.convex.convex_hull(points))


@pytest.mark.parametrize("geometry", [Box((0.1, 0.2, 0.3)), Cylinder(0.1, 0.2)])
@given(st.tuples(LENGTH, LENGTH, LENGTH), st.tuples(ANGLE, ANGLE, ANGLE))
def test_parts_stand_where_trimesh_puts_them(
    geometry: Geometry, place: tuple[float, float, float], turns: tuple[float, float, float]
) -> None:
    pose = Transform.from_rpy(place, turns)
    parts = (Part(geometry, Transform()), Part(geometry, pose))
    mesh = body_mesh(Body("thing", "thing", Transform(), parts))
    assert mesh is not None
    moved = trimesh.Trimesh(*collision_mesh(geometry), process=False)
    expected: list[Array] = [np.asarray(moved.triangles), np.zeros(())]
    expected[1] = np.asarray(moved.apply_transform(pose.matrix).triangles)
    assert np.array_equal(mesh.triangles, np.concatenate(expected))


def test_the_hull_of_the_same_points_is_computed_once() -> None:
    corners = np.array([[x, y, z] for x in (0, 0.1) for y in (0, 0.2) for z in (0, 0.3)])
    first, second = (collision_mesh(Hull(each)) for each in (corners, corners.copy()))
    assert first is second

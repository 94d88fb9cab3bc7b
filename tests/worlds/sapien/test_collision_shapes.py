"""Hulls that are boxes are taken for boxes, others are not; a disc reaches to its edge."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
import sapien
from hypothesis import given
from hypothesis import strategies as st
from momantu_worlds.sapien.build.collision_shapes import box_of, collision_shapes
from momantu_worlds.scenes.geometry.bodies import Cylinder, Hull, Part

from momantu_bt.geometry import Transform

EDGE = st.floats(0.01, 5.0)
ANGLE = st.floats(-3.1, 3.1)


@given(st.tuples(EDGE, EDGE, EDGE), st.tuples(ANGLE, ANGLE, ANGLE), st.permutations(range(8)))
def test_the_corners_of_a_box_are_that_box(
    size: tuple[float, float, float], turn: tuple[float, float, float], order: list[int]
) -> None:
    corners = np.array(list(product((-0.5, 0.5), repeat=3)))[order] * size
    found = box_of(Transform.from_rpy((0.3, -0.2, 1.0), turn).apply(corners))
    assert found is not None
    pose, edges = found
    np.testing.assert_allclose(pose.position, (0.3, -0.2, 1.0), atol=1e-5)
    np.testing.assert_allclose(np.sort(edges), np.sort(size), atol=1e-5)


@pytest.mark.parametrize("moved", [(0.02, 0.0, 0.0), (0.0, 0.0, -0.02)])
def test_a_hull_with_one_corner_elsewhere_is_no_box(moved: tuple[float, float, float]) -> None:
    corners = np.array(list(product((-0.5, 0.5), repeat=3)))
    corners[3] += moved
    assert box_of(corners) is None


def test_fewer_or_more_corners_are_no_box() -> None:
    corners = np.array(list(product((-0.5, 0.5), repeat=3)))
    assert box_of(corners[:7]) is None
    assert box_of(np.vstack([corners, (0.0, 0.0, 0.6)])) is None


def test_what_things_may_stand_on_is_made_of_boxes() -> None:
    material = sapien.physx.PhysxMaterial(0.5, 0.5, 0.0)
    corners = np.array(list(product((-0.5, 0.5), repeat=3)))
    for geometry in (Cylinder(0.5, 0.04), Hull(corners)):
        shapes = collision_shapes(Part(geometry), material, static=True)
        assert all(isinstance(each, sapien.physx.PhysxCollisionShapeBox) for each in shapes)
    for geometry in (Cylinder(0.05, 1.0), Hull(corners[:6])):
        (shape,) = collision_shapes(Part(geometry), material, static=True)
        assert not isinstance(shape, sapien.physx.PhysxCollisionShapeBox)


def test_a_disc_reaches_almost_to_its_edge_and_not_beyond() -> None:
    material = sapien.physx.PhysxMaterial(0.5, 0.5, 0.0)
    shapes = collision_shapes(Part(Cylinder(0.5, 0.04)), material, static=True)
    farthest = []
    for turn in np.linspace(0.0, 2 * np.pi, 200):
        along = np.array([np.cos(turn), np.sin(turn), 0.0])
        farthest.append(max(_extent(each, along) for each in shapes))
    assert min(farthest) > 0.97 * 0.5
    assert max(farthest) <= 0.5 + 1e-6


def _extent(shape: sapien.physx.PhysxCollisionShapeBox, along: np.ndarray) -> float:
    """How far from the middle a ray along a direction leaves a box, m."""
    pose = shape.local_pose.to_transformation_matrix()
    local = np.abs(pose[:3, :3].T @ along)
    return float(np.min(shape.half_size / np.maximum(local, 1e-9)))

"""Where a scan's plane cuts a loose body: on the plane, on the body's surface, and all of it."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
import sapien
import trimesh
from hypothesis import assume, given
from hypothesis import strategies as st
from momantu_worlds.sapien.build.meshes import TriangleMesh
from momantu_worlds.sapien.build.moving import MovingBody

from momantu_bt.geometry import Transform

RADIUS, HEIGHT = 0.1, 0.3
ANGLE = st.floats(-math.pi, math.pi)
PLACE = st.floats(-2.0, 2.0)


def can_at(pose: Transform, mesh: trimesh.Trimesh | None = None) -> MovingBody:
    entity = SimpleNamespace(pose=sapien.Pose(pose.position.tolist(), pose.quaternion.tolist()))
    if mesh is None:
        mesh = trimesh.creation.cylinder(radius=RADIUS, height=HEIGHT, sections=48)
    return MovingBody(entity, TriangleMesh(np.asarray(mesh.vertices), np.asarray(mesh.faces)))


def posed(x: float, y: float, z: float, roll: float, pitch: float, yaw: float) -> Transform:
    return Transform.from_rpy((x, y, z), (roll, pitch, yaw))


@given(PLACE, PLACE, st.floats(-0.12, 0.12), ANGLE)
def test_an_upright_can_is_cut_in_a_ring(x: float, y: float, above: float, yaw: float) -> None:
    body = can_at(posed(x, y, 0.5 + above, 0.0, 0.0, yaw))
    segments = body.cut(np.array([0.0, 0.0, 0.5]), reach=5.0)
    far = np.linalg.norm(segments - (x, y), axis=-1)
    assert far == pytest.approx(RADIUS, rel=0.01)
    around = np.linalg.norm(segments[:, 0] - segments[:, 1], axis=1).sum()
    assert around == pytest.approx(2 * math.pi * RADIUS, rel=0.01)


@given(PLACE, PLACE, st.floats(-0.2, 0.2), ANGLE, ANGLE, ANGLE)
def test_ends_of_a_cut_lie_on_the_body_and_the_ring_is_closed(
    x: float, y: float, z: float, roll: float, pitch: float, yaw: float
) -> None:
    pose = posed(x, y, z, roll, pitch, yaw)
    size = np.array([0.2, 0.3, 0.1])
    mesh = trimesh.creation.box(extents=size)
    assume(np.abs(pose.apply(mesh.vertices)[:, 2]).min() > 1e-5)  # a plane through a corner
    body = can_at(pose, mesh)
    segments = body.cut(np.zeros(3), reach=5.0)
    ends = segments.reshape(-1, 2)
    own = pose.inverse().apply(np.column_stack([ends, np.zeros(len(ends))]))
    beyond = np.abs(own) - size / 2
    assert np.all(beyond.max(axis=1, initial=-1.0) < 1e-5)
    assert np.all(np.abs(beyond).min(axis=1, initial=1.0) < 1e-5)
    apart = np.linalg.norm(ends[:, None] - ends[None], axis=2)
    np.fill_diagonal(apart, 1.0)
    assert np.all(apart.min(axis=1, initial=1.0) < 1e-5)  # each end is another one's, too


@pytest.mark.parametrize(
    ("x", "z", "reach"),
    [(0.0, HEIGHT, 5.0), (0.0, -HEIGHT, 5.0), (0.0, 0.16, 5.0), (0.0, -0.16, 5.0), (3.0, 0.0, 2.0)],
)
def test_what_lies_above_below_or_too_far_is_not_cut(x: float, z: float, reach: float) -> None:
    body = can_at(posed(x, 0.0, z, 0.0, 0.0, 0.0))
    assert body.cut(np.zeros(3), reach).shape == (0, 2, 2)


@given(PLACE, PLACE, PLACE, ANGLE, ANGLE, ANGLE)
def test_ball_and_triangles_are_where_the_body_is(
    x: float, y: float, z: float, roll: float, pitch: float, yaw: float
) -> None:
    body = can_at(posed(x, y, z, roll, pitch, yaw))
    center, radius = body.ball()
    assert center == pytest.approx((x, y, z), abs=1e-6)
    corners = body.triangles().reshape(-1, 3)
    assert np.linalg.norm(corners - center, axis=1).max() == pytest.approx(radius, abs=1e-6)

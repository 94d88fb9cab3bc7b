"""Convex hulls are the same as another library's, face by face."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_worlds.scenes.geometry.hulls import hull_mesh
from scipy.spatial import QhullError


@given(st.integers(0, 10_000), st.integers(4, 40), st.floats(0.01, 5.0))
@settings(max_examples=40)
def test_a_hull_is_closed_outward_and_as_large_as_it_is(seed, count, flat):
    points = np.random.default_rng(seed).random((count, 3)) * (1.0, 2.0, flat) + (5.0, 0.0, -3.0)
    found = hull_mesh(points)
    other = trimesh.convex.convex_hull(points)
    assert found.volume == pytest.approx(other.volume, rel=1e-6)
    mesh = trimesh.Trimesh(found.vertices, found.triangles, process=False)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(found.volume)
    assert mesh.face_normals == pytest.approx(found.normals, abs=1e-6)
    offsets = np.einsum("ij,ij->i", found.normals, found.vertices[found.triangles[:, 0]])
    assert (points @ found.normals.T <= offsets + 1e-9).all()


def test_points_in_one_plane_have_no_hull():
    with pytest.raises(QhullError):
        hull_mesh(np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]))

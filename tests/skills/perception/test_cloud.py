"""Clouds: a point lies where its pixel says, and pixels between two surfaces are left out."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.perception.camera.cloud import on_ramp, points_from_depth

K = np.array([[100.0, 0.0, 31.5], [0.0, 100.0, 23.5], [0.0, 0.0, 1.0]])


@given(st.integers(1, 4), st.integers(0, 1000))
def test_points_project_back_onto_their_pixels(stride: int, seed: int) -> None:
    depth = np.random.default_rng(seed).uniform(0.9, 0.91, (48, 64)).astype(np.float32)
    depth[:10] = 0.0
    points = points_from_depth(depth, K, stride)
    u = points[:, 0] / points[:, 2] * K[0, 0] + K[0, 2]
    v = points[:, 1] / points[:, 2] * K[1, 1] + K[1, 2]
    columns, rows = np.round(u).astype(int), np.round(v).astype(int)
    assert np.abs(u - columns).max() < 1e-6
    assert (columns % stride == 0).all()
    assert (rows >= 10).all()
    assert points[:, 2] == pytest.approx(depth[rows, columns])
    assert len(points) == len(range(0, 64, stride)) * len(
        [r for r in range(10, 48) if not r % stride]
    )


def test_a_pixel_between_near_and_far_is_on_neither() -> None:
    row = np.array([1.0, 1.0, 1.5, 2.0, 2.0])
    z = np.tile(row, (5, 1))
    assert on_ramp(z).sum(axis=0).tolist() == [0, 0, 5, 0, 0]
    assert on_ramp(z.T).sum(axis=1).tolist() == [0, 0, 5, 0, 0]


def test_clean_edges_and_slanted_surfaces_stay() -> None:
    edge = np.tile(np.array([1.0, 1.0, 2.0, 2.0]), (4, 1))
    slant = np.tile(1.0 + 0.02 * np.arange(6), (6, 1))
    assert not on_ramp(edge).any()
    assert not on_ramp(slant).any()

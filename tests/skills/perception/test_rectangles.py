"""Rectangles: size and yaw from the faces that were seen, in any position."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.perception.geometry.rectangles import fitted_to, smallest_rectangle

SIZE = (0.10, 0.06)


def seen_box(seed: int, yaw: float) -> tuple[np.ndarray, np.ndarray]:
    """Points of the top and two faces of a box at (1, 2), with noise; and those of the faces."""
    random = np.random.default_rng(seed)
    top = random.uniform(-0.5, 0.5, (400, 2)) * SIZE
    front = np.column_stack([np.full(200, -SIZE[0] / 2), random.uniform(-0.5, 0.5, 200) * SIZE[1]])
    left = np.column_stack([random.uniform(-0.5, 0.5, 200) * SIZE[0], np.full(200, SIZE[1] / 2)])
    flat = np.concatenate([top, front, left]) + 0.001 * random.standard_normal((800, 2))
    c, s = math.cos(yaw), math.sin(yaw)
    turned = flat @ np.array([[c, s], [-s, c]]) + (1.0, 2.0)
    return turned, turned[400:]


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 1000), st.floats(-3.0, 3.0))
def test_size_place_and_yaw_are_found(seed: int, yaw: float) -> None:
    points, faces = seen_box(seed, yaw)
    rectangle = fitted_to(smallest_rectangle(points), points, faces)
    assert np.hypot(*(rectangle.centre - (1.0, 2.0))) < 0.002
    assert sorted(rectangle.size) == pytest.approx(sorted(SIZE), abs=0.003)
    assert -math.pi / 4 <= rectangle.yaw < math.pi / 4 + 1e-9
    long_side = rectangle.yaw + (math.pi / 2 if rectangle.size[1] > rectangle.size[0] else 0.0)
    assert math.sin(long_side - yaw) == pytest.approx(0.0, abs=0.03)
    assert np.median(rectangle.distances(faces)) < 0.001


def test_distances_are_to_the_boundary_and_outside_counts_only_outside() -> None:
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]])
    rectangle = smallest_rectangle(np.repeat(square, 300, axis=0))
    asked = np.array([[0.5, 0.5], [0.9, 0.5], [1.3, 1.4], [0.5, -0.2]])
    assert rectangle.distances(asked) == pytest.approx([0.5, 0.1, 0.5, 0.2], abs=1e-6)
    assert rectangle.outside(asked) == pytest.approx([0.0, 0.0, 0.5, 0.2], abs=1e-6)


def test_points_in_a_line_make_a_thin_rectangle() -> None:
    line = np.column_stack([np.linspace(0, 1, 50), np.zeros(50)])
    assert smallest_rectangle(line).size.min() == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("share", [0.05, 0.1, 0.2])
@pytest.mark.parametrize("yaw", [0.0, 0.6, 2.5, -1.5])
def test_a_box_seen_from_little_above_is_as_deep_as_it_is(share: float, yaw: float) -> None:
    """Most points lie on the face before the camera; the top shows in rows 8 mm apart."""
    random = np.random.default_rng(0)
    tops = int(2500 * share)
    wide = random.uniform(-0.055, 0.055, 2500)
    rows = random.choice(np.arange(0.0, 0.0701, 0.008), tops) + random.uniform(0, 0.002, tops)
    deep = np.concatenate([rows, np.zeros(2500 - tops)])
    flat = np.column_stack([deep, wide]) + 0.0012 * random.standard_normal((2500, 2))
    c, s = math.cos(yaw), math.sin(yaw)
    turned = flat @ np.array([[c, s], [-s, c]])
    found = fitted_to(smallest_rectangle(turned), turned, turned[tops:])
    assert sorted(found.size) == pytest.approx([0.066, 0.11], abs=0.004)

"""Where a camera sees past the hand: outlines of bodies before the lens, and rays beside them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.gaze.line_of_sight import BEFORE, clearance, outline

CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
"""Of a cube of 2 m."""

RAYS = st.tuples(st.floats(-0.6, 0.6), st.floats(-0.6, 0.6)).map(
    lambda xy: np.array([*xy, 1.0]) / np.linalg.norm([*xy, 1.0])
)
BOXES = st.tuples(
    st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-0.1, 0.8)),
    st.tuples(st.floats(0.01, 0.2), st.floats(0.01, 0.2), st.floats(0.01, 0.2)),
).map(lambda place: CORNERS * place[1] + place[0])


def inside_points(corners: np.ndarray, count: int = 4000) -> np.ndarray:
    """Random points of the body before the lens."""
    shares = np.random.default_rng(0).dirichlet(np.full(len(corners), 0.15), count)
    points = shares @ corners
    return np.asarray(points[points[:, 2] > BEFORE])


@given(BOXES, RAYS)
def test_no_point_of_a_body_is_nearer_to_a_ray_than_its_outline_says(
    corners: np.ndarray, ray: np.ndarray
) -> None:
    seen = outline(corners)
    points = inside_points(corners)
    if seen is None:
        assert len(points) == 0
        return
    if len(points) == 0:
        return
    off = np.arccos(np.clip(points @ ray / np.linalg.norm(points, axis=1), -1, 1))
    assert clearance(ray, seen) <= float(off.min()) + 1e-6


@given(BOXES)
def test_a_ray_to_the_middle_of_a_body_meets_it(corners: np.ndarray) -> None:
    middle = corners.mean(axis=0)
    if middle[2] < BEFORE + 0.01:
        return
    seen = outline(corners)
    assert seen is not None
    assert clearance(middle / np.linalg.norm(middle), seen) == 0.0


def test_the_angle_beside_a_wall_is_that_to_its_edge() -> None:
    wall = CORNERS * (0.5, 2.0, 0.01) + (0.7, 0.0, 1.0)
    seen = outline(wall)
    assert seen is not None
    nearest = math.atan2(0.2, 1.01)
    assert clearance(np.array([0.0, 0.0, 1.0]), seen) == pytest.approx(nearest, abs=1e-6)


def test_what_lies_behind_hides_nothing() -> None:
    assert outline(CORNERS * 0.1 - (0.0, 0.0, 0.5)) is None

"""Rays against boxes, whose crossings are known."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.robot_setup.urdf.rays import blocked, crossings, opening_between, planes_of

COORDINATE = st.floats(-3, 3)
BOX = np.array(list(product((-1.0, 1.0), (-0.5, 0.5), (-0.25, 0.25))))


@given(st.tuples(COORDINATE, COORDINATE, COORDINATE), st.integers(0, 1000))
def test_what_lies_between_the_crossings_is_inside(start: tuple[float, ...], seed: int) -> None:
    origin, way = np.array([start]), np.random.default_rng(seed).normal(size=(1, 3))
    enter, leave = crossings(planes_of(BOX), origin, way)
    if not np.isfinite(enter[0]):
        at = np.linspace(-10, 10, 401)[:, None]
        inside = (np.abs(origin + at * way) < (1 - 1e-6, 0.5 - 1e-6, 0.25 - 1e-6)).all(axis=1)
        assert not inside.any()
        return
    for share in (0.01, 0.5, 0.99):
        point = origin[0] + (enter[0] + share * (leave[0] - enter[0])) * way[0]
        assert (np.abs(point) <= (1 + 1e-6, 0.5 + 1e-6, 0.25 + 1e-6)).all()


def test_a_ray_along_a_face_passes_by() -> None:
    enter, _ = crossings(planes_of(BOX), np.array([[0.0, 0.6, 0.0]]), np.array([[1.0, 0.0, 0.0]]))
    assert np.isinf(enter[0])


def test_what_a_ray_begins_in_does_not_block_it() -> None:
    ways = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    origins = np.zeros((2, 3))
    wall = planes_of(BOX + np.array([4.0, 0.0, 0.0]))
    hit = blocked([planes_of(BOX), wall], origins, ways)
    assert hit[0] == pytest.approx(3.0)
    assert np.isinf(hit[1])


def test_fingers_to_both_sides_leave_their_distance() -> None:
    finger = np.array(list(product((-0.05, 0.05), (0.0, 0.01), (-0.01, 0.01))))
    left, right = finger + np.array([0.0, 0.03, 0.0]), finger + np.array([0.0, -0.05, 0.0])
    assert opening_between([left, right], 0.02, 0.02) == pytest.approx(0.07)
    assert opening_between([left], 0.02, 0.02) is None


def test_fingers_above_and_below_the_pads_are_found_at_their_heights() -> None:
    """Two of three fingers stand 3 cm above and below the one that they close against."""
    finger = np.array(list(product((-0.05, 0.05), (0.0, 0.01), (-0.01, 0.01))))
    thumb = finger + np.array([0.0, 0.03, 0.0])
    two = [finger + np.array([0.0, -0.05, z]) for z in (0.03, -0.03)]
    assert opening_between([thumb, *two], 0.02, 0.02) == pytest.approx(0.07)
    assert opening_between(two, 0.02, 0.02) is None

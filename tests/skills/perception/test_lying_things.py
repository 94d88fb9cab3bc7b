"""Lying bottles and cans, measured by the points of their upper side."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.perception.objects.lying import measure
from momantu_skills.perception.surface.segment import Thing

from momantu_bt.geometry import Array

RADIUS, LENGTH = 0.033, 0.2


def upper_side(yaw: float, neck: bool, seed: int = 0) -> Thing:
    """What a camera on one side, above, sees of a lying round thing at the origin."""
    random = np.random.default_rng(seed)
    along = random.uniform(-LENGTH / 2, LENGTH / 2, 2500)
    turn = random.uniform(-1.5, 0.9, 2500)
    radius = np.where(neck & (along > 0.2 * LENGTH), 0.4 * RADIUS, RADIUS)
    aside, high = radius * np.sin(turn), RADIUS + radius * np.cos(turn)
    return as_thing(yaw, np.stack([along, aside, high], axis=1), random)


def as_thing(yaw: float, own: Array, random: np.random.Generator) -> Thing:
    c, s = math.cos(yaw), math.sin(yaw)
    points = own @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    points = points + random.normal(0.0, 0.0015, points.shape)
    return Thing(points, np.zeros(len(points), dtype=np.bool_))


@settings(max_examples=15, deadline=None)
@given(st.floats(-math.pi, math.pi), st.booleans())
def test_axis_radius_and_length_come_out(yaw: float, neck: bool) -> None:
    found = measure(upper_side(yaw, neck))
    assert found is not None
    off = abs(math.sin(found.yaw - yaw))
    assert off < math.sin(math.radians(3))
    assert found.radius == pytest.approx(RADIUS, abs=0.003)
    assert found.length == pytest.approx(LENGTH, abs=0.012)
    assert math.hypot(*found.centre) < 0.008
    assert found.neck is neck
    if neck:
        assert math.cos(found.yaw - yaw) > 0.99


def test_what_stands_or_is_a_box_is_no_lying_thing() -> None:
    random = np.random.default_rng(0)
    turn, high = random.uniform(0, 2 * math.pi, 2000), random.uniform(0, 0.13, 2000)
    side = np.stack([0.035 * np.cos(turn), 0.035 * np.sin(turn), high], axis=1)
    assert measure(as_thing(0.0, side, random)) is None
    top = np.column_stack([random.uniform(-0.1, 0.1, 1500), random.uniform(-0.035, 0.035, 1500)])
    top = np.column_stack([top, np.full(1500, 0.07)])
    front = np.column_stack([random.uniform(-0.1, 0.1, 1500), np.full(1500, -0.035)])
    front = np.column_stack([front, random.uniform(0.0, 0.07, 1500)])
    assert measure(as_thing(0.4, np.vstack([top, front]), random)) is None

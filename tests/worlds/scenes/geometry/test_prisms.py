"""Prisms hold what they are around, and tell apart what is apart."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_worlds.scenes.geometry.bodies import Body, Box, Cylinder, Mesh, Part
from momantu_worlds.scenes.geometry.plane import Rectangle
from momantu_worlds.scenes.geometry.prisms import Prism, body_prism, prism_around, tightest_prism

from momantu_bt.geometry import Pose2D, Transform

CAN = Body("can", "can", Transform(), (Part(Cylinder(0.035, 0.13), Transform((0, 0, 0.065))),))
PLACES = st.tuples(st.floats(-3, 3), st.floats(-3, 3), st.floats(-math.pi, math.pi))


def cube(x: float, y: float, bottom: float, yaw: float = 0.0) -> Prism:
    return Prism(Rectangle(Pose2D(x, y, yaw), (1.0, 1.0)), bottom, bottom + 1.0)


@given(st.lists(st.tuples(*[st.floats(-5, 5)] * 3), min_size=1, max_size=20), st.floats(-4, 4))
def test_a_prism_holds_its_points_and_is_the_least(points, yaw):
    prism = prism_around(np.array(points), yaw)
    own = prism.base.pose.inverse()
    inside = np.abs([(lambda p: (p.x, p.y))(own @ Pose2D(x, y)) for x, y, _ in points])
    assert np.all(inside <= np.array(prism.base.size) / 2 + 1e-9)
    assert inside.max(axis=0) == pytest.approx(np.array(prism.base.size) / 2, abs=1e-9)
    assert (prism.bottom, prism.top) == (min(p[2] for p in points), max(p[2] for p in points))


@given(PLACES, PLACES)
def test_keeping_clear_is_mutual_and_holds_with_less_room(a, b):
    first, second = cube(a[0], a[1], 0.0, a[2]), cube(b[0], b[1], 0.5, b[2])
    for least in (0.0, 0.3):
        assert first.clear_of([second], least) == second.clear_of([first], least)
    assert not first.clear_of([second], 0.3) or first.clear_of([second], 0.0)


@pytest.mark.parametrize(
    ("other", "least", "clear"),
    [
        (cube(1.2, 0, 0), 0.1, True),
        (cube(1.2, 0, 0), 0.3, False),
        (cube(1.0, 0, 0), 0.0, False),
        (cube(0, 0, 1.2), 0.1, True),
        (cube(0, 0, 1.2), 0.3, False),
        (cube(0, 0, -1.2), 0.1, True),
        (cube(1.2, 0, 0, math.pi / 4), 0.0, False),
    ],
)
def test_room_is_kept_sideways_and_upwards(other, least, clear):
    assert cube(0, 0, 0).clear_of([other], least) is clear


def test_a_body_takes_up_its_own_room_however_it_lies():
    upright = body_prism(CAN, Transform((1, 2, 0.5)))
    assert upright is not None
    assert upright.base.size == pytest.approx((0.07, 0.07))
    assert (upright.bottom, upright.top) == pytest.approx((0.5, 0.63))
    lying = body_prism(CAN, Transform.from_rpy((1, 2, 0.5), (0, math.pi / 2, 0)))
    assert lying is not None
    assert lying.base.size == pytest.approx((0.13, 0.07))
    assert (lying.bottom, lying.top) == pytest.approx((0.465, 0.535))


def test_what_is_only_to_be_seen_takes_up_no_room():
    look = Part(Mesh(np.zeros((3, 3)), np.zeros((1, 3), dtype=np.int32)), collision=False)
    assert body_prism(Body("look", "look", Transform(), (look,)), Transform()) is None
    touched = Body("look", "look", Transform(), (Part(look.geometry),))
    with pytest.raises(TypeError, match="a Mesh has no collision shape"):
        body_prism(touched, Transform())


def test_the_foot_is_spread_over_the_bottom():
    prism = Prism(Rectangle(Pose2D(1.0, 2.0, 0.3), (0.4, 0.2)), 0.7, 0.9)
    foot = prism.foot()
    assert foot[0] == pytest.approx((1.0, 2.0, 0.7))
    assert np.all(foot[:, 2] == 0.7)
    assert prism.base.distance(foot[:, :2]).max() == 0.0
    assert np.hypot(*(foot[:, :2] - (1.0, 2.0)).T).max() == pytest.approx(0.19, abs=1e-6)


def test_solid_parts_of_all_kinds_count():
    parts = (Part(Box((0.2, 0.2, 0.2))), Part(Cylinder(0.1, 0.4), Transform((0.3, 0, 0))))
    prism = body_prism(Body("b", "b", Transform(), parts), Transform())
    assert prism is not None
    assert prism.base.size == pytest.approx((0.5, 0.2))
    assert prism.top == pytest.approx(0.2)


@given(PLACES, st.floats(0.1, 9), st.floats(0.1, 9))
def test_the_tightest_prism_around_a_turned_box_is_the_box(place, width, depth):
    corners = Rectangle(Pose2D(*place), (width, depth)).corners()
    points = np.column_stack([corners, [0.0, 1.0, 2.0, 3.0]])
    base = tightest_prism(points).base
    assert sorted(base.size) == pytest.approx(sorted((width, depth)), abs=1e-3)
    assert (base.pose.x, base.pose.y) == pytest.approx(place[:2], abs=1e-3)


@given(st.lists(st.tuples(*[st.floats(-5, 5)] * 3), min_size=1, max_size=12))
def test_no_prism_is_tighter(points):
    points = np.array(points)
    least = tightest_prism(points)
    assert float(least.base.distance(points[:, :2]).max()) < 1e-3
    for yaw in np.linspace(0.0, math.pi / 2, 7):
        other = prism_around(points, float(yaw))
        assert math.prod(least.base.size) <= math.prod(other.base.size) + 1e-2

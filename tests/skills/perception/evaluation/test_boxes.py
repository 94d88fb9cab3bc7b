"""Overlaps and angles of things, up to symmetry."""

from __future__ import annotations

import math

import numpy as np
import pytest
from momantu_skills.perception.evaluation.boxes import Solid, angle, distance, overlap

from momantu_bt.geometry import Transform, quaternion_from_axis_angle

SIZE = (0.06, 0.09, 0.2)


def turned(axis: tuple[float, float, float], degrees: float, x: float = 0.0) -> Transform:
    return Transform((x, 0.1, 0.7), quaternion_from_axis_angle(axis, math.radians(degrees)))


def test_a_thing_covers_itself() -> None:
    one = Solid("box", turned((1, 2, 3), 50), SIZE)
    assert overlap(one, one) == pytest.approx(1.0)
    assert angle(one, one) == pytest.approx(0.0, abs=1e-4)
    assert distance(one, one) == 0.0


@pytest.mark.parametrize("shift", [0.0, 0.015, 0.03, 0.045, 0.07])
def test_overlap_of_a_shifted_box_is_the_exact_one(shift: float) -> None:
    one = Solid("box", turned((0, 0, 1), 0), SIZE)
    other = Solid("box", turned((0, 0, 1), 0, shift), SIZE)
    shared = max(0.0, SIZE[0] - shift)
    assert overlap(one, other) == pytest.approx(shared / (2 * SIZE[0] - shared), abs=1e-6)


def test_a_smaller_box_inside_covers_its_share() -> None:
    one = Solid("box", turned((0, 1, 0), 20), SIZE)
    x, y, z = (edge * 0.8 for edge in SIZE)
    half = Solid("box", turned((0, 1, 0), 20), (x, y, z))
    assert overlap(half, one) == pytest.approx(0.8**3)


def test_a_box_may_name_its_axes_otherwise() -> None:
    one = Solid("box", turned((1, 1, 0), 30), SIZE)
    turn = one.pose @ Transform(quaternion=quaternion_from_axis_angle((1, 0, 0), math.pi / 2))
    other = Solid("box", turn, (SIZE[0], SIZE[2], SIZE[1]))
    assert angle(other, one) == pytest.approx(0.0, abs=1e-4)
    assert overlap(other, one) == pytest.approx(1.0)


@pytest.mark.parametrize("degrees", [0.0, 37.0, 120.0, 180.0])
def test_round_things_may_turn_about_their_axis(degrees: float) -> None:
    base = turned((1, 0, 0), 35)
    spin = Transform(quaternion=quaternion_from_axis_angle((0, 0, 1), math.radians(degrees)))
    size = (0.07, 0.07, 0.2)
    true, one = Solid("bottle", base, size, turns=True), Solid("bottle", base @ spin, size)
    assert angle(one, true) == pytest.approx(0.0, abs=1e-4)
    assert overlap(one, true) == pytest.approx(1.0)
    held = Solid("mug", base, size)
    assert angle(Solid("mug", base @ spin, size), held) == pytest.approx(degrees, abs=1e-4)


def test_a_can_may_stand_on_its_head_and_a_bottle_may_not() -> None:
    base, over = turned((1, 0, 0), 0), turned((1, 0, 0), 180)
    for category, degrees in (("can", 0.0), ("bottle", 180.0)):
        true = Solid(category, base, (0.07, 0.07, 0.1), turns=True)
        assert angle(Solid(category, over, (0.07, 0.07, 0.1)), true) == pytest.approx(degrees)


def test_things_far_apart_do_not_overlap() -> None:
    one = Solid("can", turned((0, 0, 1), 0), (0.07, 0.07, 0.1))
    far = Solid("can", turned((0, 0, 1), 0, 0.3), (0.07, 0.07, 0.1))
    assert overlap(one, far) == 0.0
    assert np.isclose(distance(one, far), 0.3)

"""Arm and load of a moving base keep away from what stands at their height."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.navigation.control.guard import HARD_MARGIN
from momantu_skills.navigation.drive.body import Body

from momantu_bt.robot import BaseLimits

LIMITS = BaseLimits(linear=1.0, angular=1.5, linear_acceleration=1.0, angular_acceleration=3.0)
REST = (0.0, 0.0, 0.0)
HAND = np.array([[0.6, 0.0, 0.1, 0.8, 1.0]])
STATE: Any = None


class Around:
    """A planning scene with columns; `shown` of them pictures see free."""

    def __init__(self, columns: np.ndarray, parts: np.ndarray = HAND, shown: bool = False) -> None:
        self.columns, self.parts, self.shown, self.asked = columns, parts, shown, 0

    def overhang(self, state: Any) -> np.ndarray:
        return self.parts

    def solids(self, state: Any, hits: np.ndarray, reach: float) -> np.ndarray:
        return self.columns

    def not_free(self, state: Any, columns: np.ndarray) -> np.ndarray:
        self.asked += 1
        return columns[:0] if self.shown else columns


def body(scene: Any) -> Body:
    found = Body(scene, LIMITS)
    found.follow(STATE)
    found.look(STATE, np.empty((0, 2)))
    return found


def column(x: float, y: float, low: float = 0.0, high: float = 2.2) -> np.ndarray:
    return np.array([[x, y, low, high, 0.025]])


def test_a_wall_before_the_hand_stops_the_base() -> None:
    judged = body(Around(column(0.74, 0.0)))
    assert judged.share((0.3, 0.0, 0.0), REST) == 0.0
    assert judged.share((-0.3, 0.0, 0.0), REST) == 1.0


def test_a_turn_that_brings_the_hand_to_a_wall_is_stopped() -> None:
    judged = body(Around(column(0.6, 0.16)))
    assert judged.share((0.0, 0.8, 0.0), REST) < 1.0
    assert judged.share((0.0, -0.8, 0.0), REST) == 1.0


def test_along_a_wall_that_is_nearer_than_the_margin_the_base_may_drive() -> None:
    wall = np.vstack([column(x, 0.135) for x in np.arange(0.2, 1.6, 0.05)])
    judged = body(Around(wall))
    assert judged.share((0.2, 0.0, 0.0), REST) == 1.0
    assert judged.share((0.0, 0.5, 0.0), REST) == 0.0
    assert judged.share((0.2, 0.2, 0.0), REST) < 1.0


def test_what_is_in_a_wall_already_may_only_leave_it() -> None:
    wall = np.vstack([column(x, 0.08) for x in np.arange(0.2, 1.6, 0.05)])
    judged = body(Around(wall))
    assert judged.share((0.2, 0.0, 0.0), REST) == 0.0
    assert judged.share((0.0, -0.5, 0.0), REST) == 1.0


@pytest.mark.parametrize("high", [0.72, 0.79])
def test_what_is_lower_than_the_hand_is_not_in_its_way(high: float) -> None:
    assert body(Around(column(0.72, 0.0, 0.0, high))).share((0.3, 0.0, 0.0), REST) == 1.0


def test_what_pictures_show_to_be_free_is_free_and_only_they_are_asked_who_matter() -> None:
    near = Around(column(0.75, 0.0), shown=True)
    assert body(near).share((0.3, 0.0, 0.0), REST) == 1.0
    assert near.asked == 1
    far = Around(column(1.6, 1.0), shown=True)
    assert body(far).share((0.3, 0.0, 0.0), REST) == 1.0
    assert far.asked == 0


def test_an_arm_over_the_base_is_no_reason_to_look() -> None:
    scene = Around(column(0.3, 0.0), parts=np.empty((0, 5)))
    assert body(scene).share((1.0, 1.5, 0.0), REST) == 1.0


@given(
    st.floats(0.2, 1.2),
    st.floats(-math.pi, math.pi),
    st.floats(-0.4, 1.0),
    st.floats(-1.5, 1.5),
    st.floats(-0.3, 0.3),
    st.floats(-0.5, 0.5),
)
def test_looking_at_what_is_near_alone_changes_no_judgement(
    away: float, bearing: float, linear: float, angular: float, speed: float, turning: float
) -> None:
    from momantu_skills.navigation.control.guard import safe_share

    there = column(0.6 + away * math.cos(bearing), away * math.sin(bearing))
    command, moving = (linear, angular, 0.0), (speed, turning, 0.0)
    whole = safe_share(command, moving, LIMITS, HAND, there)
    assert body(Around(there)).share(command, moving) == whole
    assert HARD_MARGIN > 0.0

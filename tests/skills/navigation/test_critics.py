"""The controller's critics: each grows with what it is against, and in proportion to its weight."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.navigation.config import CriticWeights
from momantu_skills.navigation.control import critics
from momantu_skills.navigation.control.critics import Critics

ASKED = {"margin": 0.03, "comfort": 0.12, "near_speed": 0.3, "far_clearance": 0.4}
USUAL = Critics(**CriticWeights().model_dump(), **ASKED)
NONE = Critics(0.0, 0.0, 0.0, 0.0, 0.0, **ASKED)
SPARE, SPEED = st.floats(0.0, 3.0), st.floats(0.0, 1.0)


def test_every_weight_has_a_critic_of_its_name() -> None:
    for name in CriticWeights.model_fields:
        assert callable(getattr(critics, name))
        assert name in Critics._fields


@given(st.integers(0, 20), st.floats(-0.2, -0.01))
def test_an_earlier_and_a_deeper_collision_is_worse(step: int, spare: float) -> None:
    cost = critics.collision(USUAL, spare, step, 22)
    assert cost > critics.collision(USUAL, spare, step + 1, 22)
    assert cost < critics.collision(USUAL, spare - 0.05, step, 22)
    assert cost > critics.collision(NONE, spare, step, 22) > 0.0


@given(SPARE, SPEED)
def test_nearness_falls_with_room_and_grows_with_speed(spare: float, speed: float) -> None:
    cost = critics.nearness(USUAL, spare, speed, 0.1)
    assert cost > critics.nearness(USUAL, spare + 0.1, speed, 0.1)
    assert cost < critics.nearness(USUAL, spare, speed + 0.1, 0.1)
    assert critics.nearness(NONE, spare, speed, 0.1) == 0.0


@given(SPARE, SPEED)
def test_haste_begins_where_the_room_does_not_allow_the_speed(spare: float, speed: float) -> None:
    room = min(spare / (0.4 - 0.03), 1.0)
    over = speed - (0.3 + room * 0.7)
    assert critics.haste(USUAL, spare, speed, 1.0, 0.1) == pytest.approx(
        25.0 * max(0.0, over) ** 2 * 0.1
    )


@given(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
def test_smoothness_is_against_either_change_of_turning(turn: float, before: float) -> None:
    cost = critics.smoothness(USUAL, turn, before)
    assert cost == pytest.approx(critics.smoothness(USUAL, before, turn))
    assert cost == pytest.approx(0.05 * (turn - before) ** 2)


@given(st.floats(-math.pi, math.pi), st.floats(-math.pi, math.pi))
def test_heading_is_free_down_the_slope_and_worst_up_it(yaw: float, slope: float) -> None:
    dx, dy = math.cos(slope), math.sin(slope)
    cost = critics.heading(USUAL, yaw, dx, dy, 1.0)
    assert cost == pytest.approx(0.7 * (1.0 + np.cos(yaw - slope)), abs=1e-9)
    assert critics.heading(USUAL, slope + math.pi, dx, dy, 1.0) == pytest.approx(0.0, abs=1e-9)


def test_progress_is_a_share_of_what_is_to_go() -> None:
    assert critics.progress(5.0, 20) == pytest.approx(critics.ON_THE_WAY * 5.0 / 20)

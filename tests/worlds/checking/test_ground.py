"""The floor as a grid: clearance, what hangs together, what stands in the way."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_worlds.checking.ground import CELL, Ground, Obstacle, obstacle
from momantu_worlds.scenes.geometry.bodies import Box, Cylinder, Part
from momantu_worlds.scenes.geometry.convex import convex

from momantu_bt.geometry import Transform

LOW, HIGH = np.array([-2.0, -2.0]), np.array([2.0, 2.0])
near = st.floats(-1.2, 1.2)


def square(x: float, y: float, half: float = 0.3) -> Obstacle:
    corners = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)]) * half + (x, y)
    return Obstacle("crate", corners)


@given(near, near, near, near)
def test_clearance_is_the_distance_to_the_nearest_obstacle(
    x: float, y: float, at_x: float, at_y: float
) -> None:
    ground = Ground([square(x, y)], LOW, HIGH)
    out = np.maximum(np.abs(np.array([at_x - x, at_y - y])) - 0.3, 0.0)
    border = 2.0 - max(abs(at_x), abs(at_y))
    expected = min(float(np.hypot(*out)), border)
    assert ground.room_at((at_x, at_y)) == pytest.approx(expected, abs=1.5 * CELL)


@given(near, near)
def test_distance_and_depth_agree_with_the_outline(x: float, y: float) -> None:
    each = square(0.0, 0.0)
    other = square(x, y).outline
    assert each.depth(other) == pytest.approx(max(0.0, 0.6 - max(abs(x), abs(y))), abs=1e-9)
    inside = max(abs(x), abs(y)) < 0.3
    assert (each.distance((x, y)) < 0) == inside


@pytest.mark.parametrize(("gap", "through"), [(0.44, False), (0.56, True)])
def test_a_disc_gets_through_what_is_wider_than_it(gap: float, through: bool) -> None:
    walls = [
        Obstacle("wall", np.array([(0.05, gap / 2), (0.05, 2), (-0.05, 2), (-0.05, gap / 2)])),
        Obstacle("wall", np.array([(0.05, -2), (0.05, -gap / 2), (-0.05, -gap / 2), (-0.05, -2)])),
    ]
    ground = Ground(walls, LOW, HIGH)
    reached = ground.reached((-1.0, 0.0), 0.25)
    assert ground.at(reached, (1.0, 0.0)) is through
    assert ground.at(reached, (-1.0, 1.0))


def test_a_start_without_room_reaches_nothing() -> None:
    ground = Ground([square(0.0, 0.0, 1.0)], LOW, HIGH)
    assert not ground.reached((0.0, 0.0), 0.25).any()
    assert ground.blocking((0.0, 0.0)) == "crate"
    assert ground.blocking((0.0, 0.0), lambda body: body == "crate") == ""


@pytest.mark.parametrize(
    ("bottom", "top", "stands"), [(0.0, 0.02, False), (1.3, 2.0, False), (0.6, 0.7, True)]
)
def test_only_what_is_between_floor_and_ceiling_is_in_the_way(
    bottom: float, top: float, stands: bool
) -> None:
    solid = convex(Part(Box((0.5, 0.5, top - bottom))), Transform((0, 0, (top + bottom) / 2)))
    assert (obstacle("board", solid, 1.2) is not None) is stands


def test_a_round_outline_is_round() -> None:
    solid = convex(Part(Cylinder(0.5, 1.0)), Transform((0.0, 0.0, 0.5)))
    found = obstacle("column", solid, 1.2)
    assert found is not None
    for turn in np.linspace(0, math.tau, 17):
        assert found.distance((math.cos(turn), math.sin(turn))) == pytest.approx(0.5, abs=0.01)

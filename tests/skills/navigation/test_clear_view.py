"""Stands behind walls are left out; a surface does not hide itself."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.plan.clear_view import in_view
from momantu_skills.navigation.plan.goals import Stand, before_surface

from momantu_bt.formats.maps import FREE, OCCUPIED, UNKNOWN
from momantu_bt.geometry import Pose2D
from momantu_bt.robot import Working
from momantu_bt.world import Surface

WORKING = Working(stand_off=0.42, look_off=0.60, reach=(0.50, 0.70, 0.95))
CELL, HALF = 0.05, 4.0
SIDES = (0.0, math.pi / 2, -math.pi / 2, math.pi)
TABLES = st.builds(
    Surface,
    st.builds(Pose2D, st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-0.3, 0.3)),
    st.tuples(st.floats(0.5, 1.0), st.floats(0.5, 1.6)),
    st.just(0.7),
    st.just(SIDES),
)


def _floor(value: int = FREE) -> np.ndarray:
    cells = round(2 * HALF / CELL)
    return np.full((cells, cells), value, np.uint8)


def _grid(cells: np.ndarray) -> GridMap:
    return GridMap(cells, CELL, (-HALF, -HALF))


def _seen(table: Surface, cells: np.ndarray) -> list[Stand]:
    middle = table.map_from_surface
    return in_view(before_surface(table, WORKING), (middle.x, middle.y), table, _grid(cells))


def _wall_at(x: float) -> slice:
    column = math.floor((x + HALF) / CELL)
    return slice(column, column + 3)


def _right_edge(table: Surface) -> float:
    at, (width, depth) = table.map_from_surface, table.size
    return at.x + (width * math.cos(at.yaw) + depth * abs(math.sin(at.yaw))) / 2


@given(TABLES)
def test_on_free_floor_all_are_in_view(table: Surface) -> None:
    assert _seen(table, _floor()) == before_surface(table, WORKING)


@given(TABLES, st.floats(0.07, 0.3), st.sampled_from([OCCUPIED, UNKNOWN]))
def test_none_is_behind_a_wall_and_none_before_it_is_left_out(
    table: Surface, gap: float, kind: int
) -> None:
    cells = _floor()
    wall = _right_edge(table) + gap
    cells[:, _wall_at(wall)] = kind
    seen = _seen(table, cells)
    assert all(each.pose.x < wall for each in seen)
    before = [each for each in before_surface(table, WORKING) if each.pose.x < wall - CELL]
    assert [each for each in seen if each in before] == before


@given(TABLES)
def test_what_is_drawn_of_the_surface_hides_nothing(table: Surface) -> None:
    cells = _floor()
    at, (width, depth) = table.map_from_surface, table.size
    for x in np.arange(-width / 2, width / 2, 0.02):
        for y in np.arange(-depth / 2, depth / 2, 0.02):
            corner = at @ Pose2D(float(x), float(y))
            cells[_grid(cells).index(corner.x, corner.y)] = OCCUPIED
    assert _seen(table, cells) == before_surface(table, WORKING)


@given(TABLES)
def test_where_nobody_has_been_all_are_kept(table: Surface) -> None:
    assert _seen(table, _floor(UNKNOWN)) == before_surface(table, WORKING)


@given(TABLES)
def test_a_stand_off_the_map_is_left_out(table: Surface) -> None:
    aside = Surface(Pose2D(HALF - 0.9, 0.0), table.size, table.height, SIDES)
    assert all(_grid(_floor()).contains(s.pose.x, s.pose.y) for s in _seen(aside, _floor()))

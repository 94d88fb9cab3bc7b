"""Gaps between rectangles, and what a disc gets through."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_worlds.scenes.geometry.plane import Rectangle, clear_of, gap, passages

from momantu_bt.geometry import Pose2D

place = st.floats(-3, 3)
edge = st.floats(0.05, 2)
rectangles = st.builds(
    lambda x, y, yaw, a, b: Rectangle(Pose2D(x, y, yaw), (a, b)),
    place,
    place,
    st.floats(-math.pi, math.pi),
    edge,
    edge,
)


def border(rectangle: Rectangle) -> np.ndarray:
    corners = rectangle.corners()
    steps = np.linspace(0, 1, 60)[:, None]
    ends = np.roll(corners, -1, axis=0)
    return np.concatenate([a + steps * (b - a) for a, b in zip(corners, ends, strict=True)])


@given(rectangles, rectangles)
def test_a_gap_is_the_same_from_both_sides(a, b):
    assert gap(a, b) == pytest.approx(gap(b, a), abs=1e-12)


@given(rectangles, rectangles)
def test_a_gap_is_the_least_distance_of_the_borders(a, b):
    sampled = float(b.distance(border(a)).min())
    # the sampling steps over at most 2 m / 59 of an edge
    assert gap(a, b) <= sampled + 1e-9
    if gap(a, b) > 0:
        assert sampled - gap(a, b) < 0.035


@given(rectangles, place, place)
def test_a_shift_of_the_whole_plane_keeps_gaps(a, x, y):
    b = Rectangle(Pose2D(1.0, 0.5, 0.3), (0.4, 0.9))

    def moved(r: Rectangle) -> Rectangle:
        return Rectangle(Pose2D(r.pose.x + x, r.pose.y + y, r.pose.yaw), r.size)

    assert gap(moved(a), moved(b)) == pytest.approx(gap(a, b), abs=1e-9)


@given(rectangles)
def test_corners_lie_on_the_border_and_the_middle_inside(a):
    assert np.allclose(a.distance(a.corners()), 0.0, atol=1e-9)
    assert float(a.distance(np.array([a.pose.x, a.pose.y]))) == 0.0
    assert gap(a, a) == 0.0


@given(rectangles, rectangles, st.floats(0, 1))
def test_clear_of_agrees_with_gap(a, b, least):
    assert clear_of(a, [b], least) == (gap(a, b) >= least and gap(a, b) > 0)


def test_what_overlaps_is_not_clear_even_when_no_gap_is_asked():
    a = Rectangle(Pose2D(0, 0), (1, 1))
    assert not clear_of(a, [a], 0.0)


@pytest.mark.parametrize(("radius", "through"), [(0.3, True), (0.45, True), (0.6, False)])
def test_a_disc_gets_through_a_door_that_is_wide_enough(radius, through):
    door = 1.1
    wall = (4.0 - door) / 2
    walls = [
        Rectangle(Pose2D(0, door / 2 + wall / 2), (0.15, wall)),
        Rectangle(Pose2D(0, -door / 2 - wall / 2), (0.15, wall)),
    ]
    grid = passages(walls, (0, 0), (6, 4), radius, cell=0.05)
    assert grid.reachable((-2, 0))[grid.index((2, 0.5))] == through


def test_a_disc_does_not_leave_the_area():
    grid = passages([], (1, 2), (4, 3), 0.2)
    reached = grid.reachable((1, 2))
    assert not reached[[0, -1]].any()
    assert not reached[:, [0, -1]].any()
    assert reached.sum() == grid.free.sum()


def test_nothing_is_reached_from_inside_an_obstacle():
    grid = passages([Rectangle(Pose2D(0, 0), (1, 1))], (0, 0), (4, 4), 0.2)
    assert not grid.reachable((0, 0)).any()


def test_a_route_is_a_shortest_chain_of_free_neighbours():
    wall = Rectangle(Pose2D(0.0, 0.5), (0.2, 3.0))
    grid = passages([wall], (0.0, 0.0), (4.0, 4.0), 0.2)
    start, end = grid.nearest_free((-1.0, 0.0)), grid.nearest_free((1.0, 0.0))
    way = grid.route(start, end)
    assert way[0] == pytest.approx(start)
    assert way[-1] == pytest.approx(end)
    steps = np.abs(np.diff(way, axis=0))
    assert steps.sum(axis=1) == pytest.approx(np.full(len(steps), 0.1))
    assert wall.distance(way).min() >= 0.2 - 1e-9
    # down to the wall's lower end, past it, and up again
    assert steps.sum() == pytest.approx(end[0] - start[0] + 2 * (start[1] + 1.2), abs=0.25)


def test_there_is_no_route_through_a_closed_wall_or_from_within_it():
    wall = Rectangle(Pose2D(0.0, 0.0), (0.2, 4.0))
    grid = passages([wall], (0.0, 0.0), (4.0, 4.0), 0.2)
    left, right = grid.nearest_free((-1.0, 0.0)), grid.nearest_free((1.0, 0.0))
    assert len(grid.route(left, right)) == 0
    assert len(grid.route((0.0, 0.0), right)) == 0
    assert len(grid.route(left, left)) == 1


def test_the_nearest_free_cell_is_the_point_or_beside_what_stands_on_it():
    block = Rectangle(Pose2D(0.0, 0.0), (1.0, 1.0))
    grid = passages([block], (0.0, 0.0), (4.0, 4.0), 0.2)
    assert grid.nearest_free((1.05, 1.05)) == pytest.approx((1.05, 1.05))
    x, y = grid.nearest_free((0.3, 0.0))
    assert (x, abs(y)) == pytest.approx((0.75, 0.05))
    full = passages([Rectangle(Pose2D(0.0, 0.0), (9.0, 9.0))], (0.0, 0.0), (4.0, 4.0), 0.2)
    with pytest.raises(ValueError, match="no cell is free"):
        full.nearest_free((0.0, 0.0))

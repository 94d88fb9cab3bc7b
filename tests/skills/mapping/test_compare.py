"""Comparing maps: turned and moved maps are found again, and so is a wall that is gone."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, example, given, settings
from hypothesis import strategies as st
from momantu_skills.mapping.comparing import agreement, align
from momantu_skills.mapping.comparing.side import Side
from momantu_skills.navigation.map.maps import GridMap

from momantu_bt.formats.maps import OCCUPIED, UNKNOWN
from momantu_bt.geometry import Pose2D
from tests.skills.mapping.plans import drawn
from tests.skills.mapping.walls import RING, box

HOUSE = [*RING, *box(16, 0, 5, 5), (18.0, 5.0, 18.0, 3.5)]
GONE = (0.0, 5.0, 1.2, 5.0)
"""A wall of RING."""
CENTRED = Pose2D(0.025, 0.025)
"""Walls on the middles of cells: drawing them moves them nowhere."""
A = Side(drawn(HOUSE, 0.05, CENTRED))


@settings(
    max_examples=5,
    deadline=None,
    derandomize=True,
    phases=[Phase.explicit, Phase.generate],
    suppress_health_check=[HealthCheck.too_slow],
)
@given(
    x=st.floats(-30.0, 30.0),
    y=st.floats(-30.0, 30.0),
    yaw=st.floats(-math.pi, math.pi),
    resolution=st.sampled_from([0.05, 0.03, 0.1]),
)
@example(x=0.0, y=0.0, yaw=0.0, resolution=0.05)
@example(x=12.34, y=-5.67, yaw=math.pi, resolution=0.05)
def test_a_map_that_is_turned_and_moved_is_found_again(x, y, yaw, resolution):
    b_from_walls = Pose2D(x, y, yaw)
    b_from_a = b_from_walls @ CENTRED.inverse()
    found = align.align(A, Side(drawn(HOUSE, resolution, b_from_walls)))
    assert found is not None
    assert not found.rivals
    middle = np.array([[10.0, 6.0]])
    off = found.a_from_b.inverse().apply(middle) - b_from_a.apply(middle)
    # walls along the cells are drawn up to half a cell beside where they stand
    assert np.abs(off).max() < max(0.05, resolution) / 2 + 0.002
    turn = found.a_from_b.yaw + yaw
    assert abs(math.remainder(turn, math.tau)) < math.radians(0.3)


def test_both_directions_tell_the_same():
    b = Side(drawn(HOUSE, 0.05, Pose2D(3.0, 1.0, 0.7)))
    forth, back = align.align(A, b), align.align(b, A)
    both = forth.a_from_b @ back.a_from_b
    assert math.hypot(both.x, both.y) < 0.05
    assert abs(both.yaw) < math.radians(0.3)


@pytest.mark.parametrize("yaw", [0.0, 0.4])
def test_a_wall_that_is_gone_is_found(yaw):
    b = Side(drawn([wall for wall in HOUSE if wall != GONE], 0.05, Pose2D(1.0, 2.0, yaw)))
    found = align.align(A, b)
    told = agreement.judged(A, b, found.a_from_b.inverse())
    only = agreement.things(A, told.missing, Pose2D(0.0, 0.0))
    assert len(only) == 1
    assert only[0].middle == pytest.approx((0.65, 5.0), abs=0.1)
    assert only[0].size[0] == pytest.approx(1.1, abs=0.15)
    other = agreement.judged(b, A, found.a_from_b)
    assert not agreement.things(b, other.missing, found.a_from_b)
    areas = agreement.overlaid(A, b, found.a_from_b).areas
    assert areas["occupied_in_a_free_in_b_m2"] == pytest.approx(1.1 * 0.05, rel=0.4)
    assert areas["free_in_a_occupied_in_b_m2"] == 0.0


def test_a_part_of_a_map_lies_where_it_was_cut_out():
    grid = drawn(HOUSE, 0.05, Pose2D(0.0, 0.0, 0.3))
    part = GridMap(grid.cells[:, : grid.cells.shape[1] // 2], grid.resolution, grid.origin)
    found = align.align(A, Side(part))
    assert math.hypot(found.a_from_b.x, found.a_from_b.y) < 0.1
    assert found.a_from_b.yaw == pytest.approx(-0.3, abs=math.radians(0.3))
    areas = agreement.overlaid(A, Side(part), found.a_from_b).areas
    assert areas["known_only_to_b_m2"] < 1.0
    assert areas["known_only_to_a_m2"] > 50.0


def test_a_square_room_fits_in_four_ways():
    room = Side(drawn(box(0, 0, 6, 6)))
    found = align.align(room, Side(drawn(box(0, 0, 6, 6), 0.05, Pose2D(2.0, 1.0, 0.2))))
    assert len(found.rivals) == 3


def test_other_buildings_do_not_fit():
    other = [*box(0, 0, 4, 30), *box(4, 6, 9, 1.5), *box(-7, 20, 7, 7), *box(1, 2, 1, 1)]
    assert align.align(A, Side(drawn(other))) is None


def test_without_walls_nothing_is_compared():
    empty = GridMap(np.full((40, 40), UNKNOWN, np.uint8), 0.05, (0.0, 0.0))
    assert align.align(A, Side(empty)) is None
    one = empty.cells.copy()
    one[20, 20] = OCCUPIED
    assert align.align(A, Side(GridMap(one, 0.05, (0.0, 0.0)))) is None

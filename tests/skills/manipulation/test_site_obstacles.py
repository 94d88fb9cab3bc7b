"""What hangs over surfaces: a solid for the arm, and in the way of a look."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.manipulation.scene.site_obstacles import (
    BESIDE,
    HIGHER,
    Overhead,
    hanging,
    overhead_of,
)

from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.world import Overhang, Surface

PLACES = st.builds(Pose2D, st.floats(-4, 4), st.floats(-4, 4), st.floats(-3.1, 3.1))
SIZES = st.tuples(st.floats(0.05, 1.0), st.floats(0.05, 2.0))
HALF = np.array([0.3, 1.0, 0.015])


BOARD = Overhead(Transform((0.0, 0.0, 1.085)), HALF)


@given(PLACES, PLACES, PLACES, SIZES, st.floats(0.5, 1.5), st.floats(0.01, 0.5))
def test_the_solid_holds_what_the_site_tells_and_as_much_as_it_may_be_wrong(
    odom_from_map: Pose2D,
    base: Pose2D,
    place: Pose2D,
    size: tuple[float, float],
    bottom: float,
    thick: float,
) -> None:
    surface = Surface(place, size, 0.3, (0.0,), (Overhang(place, size, bottom, bottom + thick),))
    (solid,) = overhead_of(surface, odom_from_map.transform())
    base_from_odom = base.transform().inverse()
    map_from_base = odom_from_map.transform().inverse() @ base.transform()
    corners = map_from_base.apply(solid.obstacle(base_from_odom, "over").corners)
    own = place.transform().inverse().apply(corners)
    assert own[:, 2].min() == pytest.approx(bottom - HIGHER)
    assert own[:, 2].max() == pytest.approx(bottom + thick + HIGHER)
    assert np.abs(own[:, :2]) == pytest.approx(np.tile(np.array(size) / 2 + BESIDE, (8, 1)))


@settings(max_examples=60)
@given(PLACES, st.integers(0, 9999))
def test_a_line_is_barred_where_points_along_it_lie_inside(place: Pose2D, seed: int) -> None:
    solid, random = Overhead(place.transform(1.085), HALF), np.random.default_rng(seed)
    own = random.uniform((-0.6, -1.5, -0.3), (0.6, 1.5, 0.3), (2, 3))
    start, end = solid.odom_from_box.apply(own)
    along = own[0] + np.linspace(0.0, 1.0, 4000)[:, None] * (own[1] - own[0])
    inside = (np.abs(along) <= HALF).all(axis=1).any()
    assert solid.between(start, end) == inside
    assert solid.between(end, start) == inside


@pytest.mark.parametrize(
    ("start", "end", "barred"),
    [
        ((0.0, 0.0, 0.7), (0.0, 0.0, 1.4), True),
        ((0.0, 0.0, 0.7), (0.0, 0.5, 0.7), False),
        ((0.4, 0.0, 0.7), (0.4, 0.0, 1.4), False),
    ],
)
def test_so_is_one_along_an_axis(start: Any, end: Any, barred: bool) -> None:
    assert BOARD.between(np.array(start), np.array(end)) is barred


@pytest.mark.parametrize(
    ("point", "far"), [((0.1, 0.5, 0.0), 0.0), ((1.3, 0.0, 2.0), 1.0), ((0.6, 1.4, 0.0), 0.5)]
)
def test_distances_are_those_along_the_floor(point: tuple[float, ...], far: float) -> None:
    assert BOARD.distance(np.array(point)) == pytest.approx(far)


def test_a_surface_over_which_nothing_hangs_has_none() -> None:
    assert overhead_of(Surface(Pose2D(0, 0), (1.0, 1.0), 0.7, (0.0,)), Transform()) == ()


def test_only_what_is_near_is_in_the_arms_way() -> None:
    far = Overhead(Transform((4.0, 0.0, 1.0)), HALF)
    found = hanging([BOARD, far], Pose2D(0.5, 0.0, 1.0).transform().inverse(), 2.0)
    assert [solid.name for solid in found] == ["over 0"]

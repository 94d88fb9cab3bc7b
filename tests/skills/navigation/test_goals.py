"""Stands face what they are for, keep their distance, and come best first."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.navigation.plan.goals import before_surface, surface_at, within_reach

from momantu_bt.geometry import Pose2D, wrap_angle
from momantu_bt.robot import Working
from momantu_bt.world import Surface

WORKING = Working(stand_off=0.42, look_off=0.60, reach=(0.50, 0.70, 0.95))
POSES = st.builds(Pose2D, st.floats(-5, 5), st.floats(-5, 5), st.floats(-math.pi, math.pi))
SURFACES = st.builds(
    Surface,
    POSES,
    st.tuples(st.floats(0.4, 1.0), st.floats(0.6, 2.0)),
    st.just(0.7),
    st.just((0.0, math.pi)),
)


def _outside(surface: Surface, pose: Pose2D) -> float:
    here = surface.map_from_surface.inverse() @ pose
    return max(abs(here.x) - surface.size[0] / 2, abs(here.y) - surface.size[1] / 2)


@given(SURFACES)
def test_stands_before_a_surface_look_at_its_middle_from_outside(surface: Surface) -> None:
    for stand in before_surface(surface, WORKING):
        middle = stand.pose.inverse() @ surface.map_from_surface
        assert abs(math.atan2(middle.y, middle.x)) < 1e-6
        assert _outside(surface, stand.pose) >= WORKING.look_off - 1e-9


@given(SURFACES)
def test_the_first_stand_is_the_preferred_side(surface: Surface) -> None:
    first = min(before_surface(surface, WORKING), key=lambda stand: stand.cost)
    here = surface.map_from_surface.inverse() @ first.pose
    assert abs(wrap_angle(math.atan2(here.y, here.x) - surface.sides[0])) < 1e-6


@given(SURFACES, st.floats(0.30, 0.50), st.floats(-0.25, 0.25), st.floats(-0.2, 0.2))
def test_too_near_before_a_side_the_first_stand_is_straight_behind(
    surface: Surface, off: float, along: float, turn: float
) -> None:
    edge = surface.size[0] / 2
    base = surface.map_from_surface @ Pose2D(edge + off, along, math.pi + turn)
    first = min(before_surface(surface, WORKING, base), key=lambda stand: stand.cost)
    here = surface.map_from_surface.inverse() @ first.pose
    assert here.x == pytest.approx(edge + WORKING.look_off)
    assert here.y == pytest.approx(along)
    assert abs(wrap_angle(here.yaw - math.pi)) < 1e-6


@given(SURFACES, POSES)
def test_from_elsewhere_stands_are_those_of_nobody(surface: Surface, base: Pose2D) -> None:
    far = surface.map_from_surface @ Pose2D(3.0, 0.0, math.pi)
    across = surface.map_from_surface @ Pose2D(surface.size[0] / 2 + 0.4, 0.0, math.pi / 2)
    for elsewhere in (far, across):
        assert before_surface(surface, WORKING, elsewhere) == before_surface(surface, WORKING)


@given(SURFACES, st.floats(-0.4, 0.4), st.floats(-0.4, 0.4), POSES)
def test_stands_within_reach_are_square_and_near(
    surface: Surface, u: float, v: float, base: Pose2D
) -> None:
    spot = surface.map_from_surface @ Pose2D(u * surface.size[0], v * surface.size[1], 0.0)
    stands = within_reach((spot.x, spot.y), [surface], base, WORKING)
    assert [s.cost for s in stands] == sorted(s.cost for s in stands)
    for stand in stands:
        assert stand.pose.distance_to(spot) <= WORKING.reach[2] + 1e-9 or _too_far_in(
            surface, spot, stand.pose.distance_to(spot)
        )
        square = (surface.map_from_surface.inverse() @ stand.pose).yaw
        if _outside(surface, stand.pose) > 0:
            assert abs(math.sin(2 * square)) < 1e-6
            assert _outside(surface, stand.pose) > WORKING.stand_off - 1e-6


def _too_far_in(surface: Surface, spot: Pose2D, distance: float) -> bool:
    """Whether no edge is near enough, and `distance` is about what the nearest one allows."""
    local = surface.map_from_surface.inverse() @ spot
    ways = [
        _half(surface, angle) - (math.cos(angle) * local.x + math.sin(angle) * local.y)
        for angle in surface.sides
    ]
    nearest = min(ways) + WORKING.stand_off
    return nearest > WORKING.reach[2] - 0.05 and distance <= nearest + 0.2


def _half(surface: Surface, angle: float) -> float:
    x, y = surface.size
    return abs(math.cos(angle)) * x / 2 + abs(math.sin(angle)) * y / 2


@given(POSES, POSES)
def test_a_point_in_the_open_is_faced_from_all_round(spot: Pose2D, base: Pose2D) -> None:
    stands = within_reach((spot.x, spot.y), [], base, WORKING)
    assert len({stand.variant for stand in stands}) == len(stands) == 16
    for stand in stands:
        seen = stand.pose.inverse() @ spot
        assert seen.x == pytest.approx(WORKING.reach[1], abs=1e-9)
        assert seen.y == pytest.approx(0.0, abs=1e-9)


DISCS = st.builds(
    lambda pose, across: Surface(pose, (across, across), 0.7, (0.0, math.pi / 2), round=True),
    POSES,
    st.floats(0.5, 1.2),
)


@given(DISCS, st.floats(0.0, 1.0), st.floats(-math.pi, math.pi), POSES)
def test_a_round_table_is_approached_from_all_around_its_sides(
    surface: Surface, share: float, turn: float, base: Pose2D
) -> None:
    away = share * surface.size[0] / 2
    here = Pose2D(away * math.cos(turn), away * math.sin(turn), 0.0)
    spot = surface.map_from_surface @ here
    stands = within_reach((spot.x, spot.y), [surface], base, WORKING)
    for stand in stands:
        own = surface.map_from_surface.inverse() @ stand.pose
        assert math.hypot(own.x, own.y) >= surface.size[0] / 2 + WORKING.stand_off - 1e-6
        # nobody told that it can be approached from the other side
        assert min(abs(wrap_angle(own.yaw + math.pi - side)) for side in surface.sides) < 0.9


@given(DISCS)
def test_what_lies_beside_a_round_table_is_not_on_it(surface: Surface) -> None:
    corner = 0.5 * surface.size[0] + 0.1
    beside = surface.map_from_surface @ Pose2D(corner, corner, 0.0)
    far = math.hypot(corner, corner) - surface.size[0] / 2
    found = surface_at((beside.x, beside.y), [surface])
    assert (found is surface) is (far < 0.20)


@given(DISCS)
def test_stands_before_a_round_table_keep_off_its_edge(surface: Surface) -> None:
    for stand in before_surface(surface, WORKING):
        own = surface.map_from_surface.inverse() @ stand.pose
        assert math.hypot(own.x, own.y) >= surface.size[0] / 2 + WORKING.look_off - 1e-6


@given(SURFACES, POSES, st.floats(-3.1, 3.1), st.floats(-0.3, 0.3))
def test_an_arm_that_reaches_aside_gets_the_point_onto_its_line(
    surface: Surface, base: Pose2D, heading: float, lateral: float
) -> None:
    own = WORKING.model_copy(update={"heading": heading, "lateral": lateral, "breadth": 0.05})
    middle = surface.map_from_surface
    stands = within_reach((middle.x, middle.y), [surface], base, own)
    assert stands
    for stand in stands:
        seen = stand.pose.inverse() @ middle
        c, s = math.cos(heading), math.sin(heading)
        along, beside = c * seen.x + s * seen.y, -s * seen.x + c * seen.y
        assert along > 0.0
        assert abs(beside - lateral) <= 0.05 + 1e-9

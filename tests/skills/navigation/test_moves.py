"""Simple moves end where they were sent, or say that they did not, and touch nothing."""

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.navigation.drive.moves import (
    CREEP_DONE,
    TURN_DONE,
    back_off,
    can_turn,
    clear_behind,
    creep,
    turn_to,
)

from momantu_bt.geometry import Pose2D, wrap_angle
from tests.skills.scenery.obedient import MakeObedient, RunMove

YAWS = st.floats(-math.pi, math.pi)
MIDDLE = st.builds(Pose2D, st.floats(2.5, 5.5), st.floats(2.5, 3.5), YAWS)


@settings(max_examples=40)
@given(MIDDLE, st.floats(-9.0, 9.0))
def test_a_turn_ends_at_the_heading_on_the_spot(
    obedient: MakeObedient, run_move: RunMove, start: Pose2D, yaw: float
) -> None:
    base = obedient(start)
    assert run_move(turn_to(base, yaw)) is True
    assert abs(wrap_angle(base.pose().yaw - yaw)) < TURN_DONE + 0.02
    assert base.pose().distance_to(start) < 1e-9
    assert base.stands()


@settings(max_examples=40)
@given(MIDDLE, st.floats(-3.1, 3.1))
def test_a_turn_takes_the_short_way(obedient: MakeObedient, start: Pose2D, turn: float) -> None:
    base = obedient(start)
    furthest = 0.0
    for _ in turn_to(base, start.yaw + turn):
        off = wrap_angle(base.pose().yaw - start.yaw)
        furthest = max(furthest, abs(off))
        assert off * turn >= -0.02 * abs(turn)
    assert furthest <= abs(turn) + 0.03


@settings(max_examples=40)
@given(MIDDLE, st.floats(0.05, 1.2))
def test_backing_off_goes_straight_back_that_far(
    obedient: MakeObedient, run_move: RunMove, start: Pose2D, distance: float
) -> None:
    base = obedient(start)
    assert run_move(back_off(base, distance)) is True
    end = start.inverse() @ base.pose()
    assert -end.x == pytest.approx(distance, abs=CREEP_DONE + 0.02)
    assert abs(end.y) < 1e-9
    assert base.stands()


@settings(max_examples=40)
@given(MIDDLE, st.floats(-0.6, 0.6), st.floats(-0.3, 0.3), YAWS)
def test_creeping_ends_level_with_the_target_and_no_further(
    obedient: MakeObedient, run_move: RunMove, start: Pose2D, ahead: float, left: float, yaw: float
) -> None:
    base = obedient(start)
    assert run_move(creep(base, start @ Pose2D(ahead, left, yaw))) is True
    end = start.inverse() @ base.pose()
    assert end.x == pytest.approx(ahead, abs=CREEP_DONE + 0.015)
    assert abs(end.y) < 1e-9


@settings(max_examples=30)
@given(st.floats(0.0, 0.5))
def test_backing_off_stops_before_what_stands_behind(
    obedient: MakeObedient, run_move: RunMove, gap: float
) -> None:
    gap = 0.05 * round(gap / 0.05)
    wall = (1.0, 2.0, 3.0 - 0.25 - gap, 4.0)
    base = obedient(Pose2D(3.0, 3.0, 0.0), [wall])
    assert run_move(back_off(base, 1.0)) is False
    assert base.room(base.pose(), whole=False) > -0.025
    assert base.pose().x > wall[2] + 0.25 - 0.05
    assert base.stands()


@pytest.mark.parametrize("move", [lambda b: turn_to(b, 3.0), lambda b: back_off(b, 0.5)])
def test_a_base_that_may_not_move_gives_up_in_bounded_time(
    obedient: MakeObedient, run_move: RunMove, move: Any
) -> None:
    base = obedient(Pose2D(4.0, 3.0, 0.0))
    base.stuck = True
    assert run_move(move(base)) is False
    assert base.now() < base.config.blocked_patience + 1.0


def test_creeping_gives_up_where_it_may_not_move(obedient: MakeObedient, run_move: RunMove) -> None:
    base = obedient(Pose2D(4.0, 3.0, 0.0))
    base.stuck = True
    assert run_move(creep(base, Pose2D(4.3, 3.0, 0.0))) is False


@given(MIDDLE, st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(0.05, 1.0))
def test_room_behind_for_far_is_room_behind_for_near(
    obedient: MakeObedient, pose: Pose2D, dx: float, dy: float, distance: float
) -> None:
    box = (3.0 + dx, 2.5 + dy, 3.4 + dx, 2.9 + dy)
    base = obedient(pose, [box])
    if base.room(pose, whole=False) > base.config.margin and clear_behind(base, pose, distance):
        for k in range(1, 10):
            behind = pose @ Pose2D(-distance * k / 10, 0.0, 0.0)
            # Only every tenth of a metre is checked: between two checks less may be left.
            assert base.room(behind, whole=False) > base.config.margin - 0.05


def test_an_arm_that_would_sweep_a_wall_may_not_turn(obedient: MakeObedient) -> None:
    wall = [(3.0, 3.6, 5.0, 3.8)]
    pose = Pose2D(4.0, 3.0, 0.0)
    assert can_turn(obedient(pose, wall), pose, math.pi / 2)
    long = obedient(pose, wall, arm=0.5)
    assert not can_turn(long, pose, math.pi / 2)
    assert not can_turn(long, pose, math.pi - 0.01)
    assert can_turn(long, pose, -math.pi / 2)


@given(MIDDLE, YAWS)
def test_in_the_open_every_turn_has_room(obedient: MakeObedient, pose: Pose2D, yaw: float) -> None:
    assert can_turn(obedient(pose, arm=0.5), pose, yaw)


def test_an_arm_that_touches_is_no_leave_to_back_the_base_into_a_wall(
    obedient: MakeObedient,
) -> None:
    pose = Pose2D(4.0, 3.0, 0.0)
    ahead, behind = (4.6, 2.0, 5.2, 4.0), (3.0, 2.0, 3.5, 4.0)
    touching = obedient(pose, [ahead, behind], arm=0.5)
    assert touching.room(pose, whole=True) < 0.0
    assert clear_behind(touching, pose, 0.15)
    assert not clear_behind(touching, pose, 0.24)

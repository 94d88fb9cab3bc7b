"""Manoeuvres near a goal: what is promised is kept, and what has no room is not begun."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.navigation.drive.arrive import arrive, within
from momantu_skills.navigation.drive.cruise import leave
from momantu_skills.navigation.drive.manoeuvre import (
    HOP,
    approach_is_sure,
    hop_bearing,
    prepare,
    quickest_retreat,
    run_in,
    straight_behind,
)

from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose2D
from tests.skills.scenery.obedient import MakeObedient, RunMove

GOAL = Pose2D(4.0, 3.0, 0.7)
NEAR = st.builds(Pose2D, st.floats(-0.9, 0.9), st.floats(-0.9, 0.9), st.floats(-3.1, 3.1))
POSES = st.builds(Pose2D, st.floats(-3, 3), st.floats(-3, 3), st.floats(-3.1, 3.1))


@settings(max_examples=60)
@given(NEAR)
def test_a_goal_nearby_is_reached_from_anywhere_around_it(
    obedient: MakeObedient, run_move: RunMove, offset: Pose2D
) -> None:
    base = obedient(GOAL @ offset)
    if math.hypot(offset.x, offset.y) > 0.05:  # nearer, only a turn is left, and arriving makes it
        assert run_move(prepare(base, GOAL, 0.05)) is True
    assert run_move(arrive(base, lambda: GOAL, 0.05, 0.05)) is True
    assert within(base.pose(), GOAL, 0.05, 0.05)
    assert base.stands()
    assert base.now() < 30.0


@settings(max_examples=40)
@given(NEAR, st.floats(0.1, 0.6))
def test_nothing_is_touched_on_the_way_between_two_walls(
    obedient: MakeObedient, run_move: RunMove, offset: Pose2D, spare: float
) -> None:
    goal = Pose2D(4.0, 3.0, 0.0)
    start = goal @ Pose2D(-0.6 + 0.3 * offset.x, 0.1 * offset.y, 0.1 * offset.yaw)
    half = 0.05 * math.ceil((0.25 + spare) / 0.05)
    walls = [(2.0, 3.0 + half, 6.0, 3.2 + half), (2.0, 2.8 - half, 6.0, 3.0 - half)]
    base = obedient(start, walls)
    before = base.room(start, whole=False)
    run_move(prepare(base, goal, 0.05))
    assert base.least > min(0.0, before) - 0.02


@settings(max_examples=60)
@given(st.builds(Pose2D, st.floats(-1.8, -0.3), st.floats(-0.4, 0.4), st.floats(-0.6, 0.6)))
def test_an_approach_that_is_sure_ends_within_its_distance(
    obedient: MakeObedient, run_move: RunMove, offset: Pose2D
) -> None:
    base = obedient(GOAL @ offset)
    if approach_is_sure(base, GOAL, 0.05):
        assert run_move(run_in(base, lambda: GOAL)) is True
        run_move(base.stop("settle"))
        assert base.pose().distance_to(GOAL) < 0.05


@settings(max_examples=40)
@given(st.floats(0.03, 1.15), st.floats(-0.02, 0.02), st.floats(-0.3, 0.3))
def test_a_goal_straight_behind_is_backed_into(
    obedient: MakeObedient, run_move: RunMove, behind: float, left: float, yaw: float
) -> None:
    start = Pose2D(4.0, 3.0, 0.0)
    goal = start @ Pose2D(-behind, left, yaw)
    base = obedient(start)
    assert straight_behind(base, goal, 0.05) == pytest.approx(behind)
    assert run_move(prepare(base, goal, 0.05)) is True
    assert set(base.phases) == {"back off"}
    assert base.pose().distance_to(goal) < 0.055


@pytest.mark.parametrize(
    "goal",
    [
        Pose2D(4.5, 3.0, 0.0),
        Pose2D(3.5, 3.2, 0.0),
        Pose2D(3.5, 3.0, 0.6),
        Pose2D(2.5, 3.0, 0.0),
        Pose2D(3.99, 3.0, 0.0),
    ],
    ids=["ahead", "beside", "turned", "too far", "there already"],
)
def test_what_is_not_straight_behind_is_not_backed_into(
    obedient: MakeObedient, goal: Pose2D
) -> None:
    assert straight_behind(obedient(Pose2D(4.0, 3.0, 0.0)), goal, 0.05) is None


def test_one_does_not_back_through_a_wall(obedient: MakeObedient) -> None:
    base = obedient(Pose2D(4.0, 3.0, 0.0), [(3.3, 2.0, 3.5, 4.0)])
    assert straight_behind(base, Pose2D(3.0, 3.0, 0.0), 0.05) is None


@given(NEAR)
def test_a_hop_points_at_the_goal(obedient: MakeObedient, offset: Pose2D) -> None:
    base = obedient(GOAL @ offset)
    bearing = hop_bearing(base, GOAL)
    way = base.pose().distance_to(GOAL)  # not of the offset: rounding would decide at the bounds
    assert (bearing is None) == (not 0.02 < way < HOP)
    if bearing is not None:
        there = base.pose() @ Pose2D(0.0, 0.0, bearing - base.pose().yaw) @ Pose2D(way, 0.0)
        assert there.distance_to(GOAL) < 1e-9


def test_there_is_no_hop_through_a_wall(obedient: MakeObedient) -> None:
    base = obedient(Pose2D(4.0, 3.0, 0.0), [(4.4, 2.0, 4.6, 4.0)])
    assert hop_bearing(base, Pose2D(5.0, 3.0, 0.0)) is None
    assert hop_bearing(base, Pose2D(4.0, 3.6, 0.0)) == pytest.approx(math.pi / 2)


def test_a_retreat_is_no_longer_than_the_room_behind(obedient: MakeObedient) -> None:
    start, goal = Pose2D(4.0, 3.0, 0.0), Pose2D(4.3, 3.25, 0.0)
    free = quickest_retreat(obedient(start), goal, 0.05)
    assert free is not None
    assert free.back > 0.3
    wall = [(3.0, 2.0, 3.5, 4.0)]
    shut = quickest_retreat(obedient(start, wall), goal, 0.05)
    assert shut is None or shut.back < 0.25


def test_a_goal_straight_ahead_needs_no_retreat(obedient: MakeObedient) -> None:
    retreat = quickest_retreat(obedient(Pose2D(3.0, 3.0, 0.0)), Pose2D(4.0, 3.0, 0.0), 0.05)
    assert retreat is not None
    assert retreat.back == 0.0


def test_a_run_in_that_is_blocked_says_so(obedient: MakeObedient, run_move: RunMove) -> None:
    base = obedient(Pose2D(3.0, 3.0, 0.0))
    base.stuck = True
    with pytest.raises(Failure) as caught:
        run_move(run_in(base, lambda: Pose2D(4.0, 3.0, 0.0)))
    assert caught.value.code == "PATH_BLOCKED"
    assert base.now() < base.config.blocked_patience + 1.0


def test_a_goal_that_always_runs_away_ends_in_no_progress(
    obedient: MakeObedient, run_move: RunMove
) -> None:
    base = obedient(Pose2D(3.0, 3.0, 0.0))

    def goal() -> Pose2D:
        return base.pose() @ Pose2D(0.06, 0.0, 0.0) if base.stands() else base.pose()

    with pytest.raises(Failure) as caught:
        run_move(arrive(base, goal, 0.05, 0.05))
    assert caught.value.code == "NO_PROGRESS"
    assert base.now() < 60.0


@given(POSES, POSES, POSES, st.floats(0.01, 1.0), st.floats(0.01, 1.0))
def test_being_within_does_not_depend_on_the_frame(
    pose: Pose2D, goal: Pose2D, frame: Pose2D, distance: float, angle: float
) -> None:
    near = pose.distance_to(goal) - distance
    turned = abs((goal.inverse() @ pose).yaw) - angle
    if abs(near) > 1e-6 and abs(turned) > 1e-6:
        expected = near < 0 and turned < 0
        assert within(pose, goal, distance, angle) is expected
        assert within(frame @ pose, frame @ goal, distance, angle) is expected
        assert within(goal, pose, distance, angle) is expected


def test_leaving_a_table_frees_the_arm(obedient: MakeObedient, run_move: RunMove) -> None:
    start = Pose2D(4.0, 3.0, 0.0)
    base = obedient(start, [(4.6, 2.0, 5.2, 4.0)], arm=0.5)
    assert base.room(start, whole=True) < 0.0
    run_move(leave(base, math.pi))
    assert base.room(base.pose(), whole=True) > 0.0
    assert base.pose().yaw == pytest.approx(0.0)


def test_with_a_wall_behind_one_leaves_no_further_than_it(
    obedient: MakeObedient, run_move: RunMove
) -> None:
    start = Pose2D(4.0, 3.0, 0.0)
    base = obedient(start, [(4.6, 2.0, 5.2, 4.0), (3.2, 2.0, 3.5, 4.0)], arm=0.5)
    run_move(leave(base, 0.0))
    assert base.least > 0.0

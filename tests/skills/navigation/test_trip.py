"""Whole trips: they arrive, keep their frame, recover as often as allowed, and then give up."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.navigation.control.mppi import Mppi
from momantu_skills.navigation.drive import trip
from momantu_skills.navigation.drive.trip import Destination, be_sure, travel
from momantu_skills.navigation.plan.goals import Stand

from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose2D
from tests.skills.scenery.obedient import MakeObedient, RunMove

TOLERANCE = (0.05, 0.05)


class Belief:
    """A localization that is as sure as it is told to be."""

    def __init__(self, sigma: float = 0.01, quality: float = 1.0) -> None:
        self.covariance, self.quality = np.eye(3) * sigma**2, quality


def _base(obedient: MakeObedient, start: Pose2D, *boxes: Any, belief: Belief | None = None) -> Any:
    base = obedient(start, boxes)
    base.localization = belief or Belief()
    return base


def _mppi(base: Any) -> Mppi:
    return Mppi(base.limits, base.config, np.random.default_rng(0))


def _to(*poses: Pose2D, **more: Any) -> Destination:
    stands = [Stand(pose, n, float(n)) for n, pose in enumerate(poses)]
    return Destination(lambda: stands, TOLERANCE, **more)


def _travel(base: Any, run_move: RunMove, to: Destination, *, recovery: bool = True) -> None:
    run_move(travel(base, _mppi(base), to, recovery=recovery))


def _code(base: Any, run_move: RunMove, to: Destination, *, recovery: bool) -> str:
    with pytest.raises(Failure) as caught:
        _travel(base, run_move, to, recovery=recovery)
    assert base.stands()
    return caught.value.code


STARTS = st.builds(Pose2D, st.floats(0.8, 3.0), st.floats(0.8, 5.2), st.floats(-3.1, 3.1))
GOALS = st.builds(Pose2D, st.floats(5.0, 7.0), st.floats(0.8, 5.2), st.floats(-3.1, 3.1))
DOOR = ((3.9, 0.0, 4.1, 2.4), (3.9, 3.6, 4.1, 6.0))


@settings(max_examples=10)
@given(STARTS, GOALS)
def test_a_trip_through_a_door_arrives_and_touches_nothing(
    obedient: MakeObedient, run_move: RunMove, start: Pose2D, goal: Pose2D
) -> None:
    base = _base(obedient, start, *DOOR)
    _travel(base, run_move, _to(goal))
    end = goal.inverse() @ base.pose()
    assert math.hypot(end.x, end.y) <= TOLERANCE[0]
    assert abs(end.yaw) <= TOLERANCE[1]
    assert base.least > 0.0
    assert base.stands()


def test_at_the_goal_nothing_is_done(obedient: MakeObedient, run_move: RunMove) -> None:
    base = _base(obedient, Pose2D(3.0, 3.0, 0.3))
    _travel(base, run_move, _to(Pose2D(3.02, 3.0, 0.32)))
    assert base.phases == []


def test_straight_back_needs_no_way_however_far_the_arm_stands_out(
    obedient: MakeObedient, run_move: RunMove
) -> None:
    base = _base(obedient, Pose2D(3.5, 3.0, 0.0), (3.8, 2.0, 4.4, 4.0))
    base.half_width = 2.0
    _travel(base, run_move, _to(Pose2D(3.2, 3.0, 0.0)), recovery=False)
    assert base.pose().distance_to(Pose2D(3.2, 3.0)) <= TOLERANCE[0]
    assert _code(base, run_move, _to(Pose2D(3.2, 4.0, 0.0)), recovery=False) == "NO_PATH"


@pytest.mark.parametrize("side", [0, 1, 2, 3])
def test_side_counts_through_the_stands_and_starts_again(
    obedient: MakeObedient, run_move: RunMove, side: int
) -> None:
    stands = [Pose2D(4.0, 3.0, 0.0), Pose2D(3.0, 4.0, 1.5), Pose2D(3.0, 2.0, -1.5)]
    base = _base(obedient, Pose2D(2.6, 3.0, 0.0))
    _travel(base, run_move, _to(*stands, side=side))
    assert base.pose().distance_to(stands[side % 3]) <= TOLERANCE[0]


@pytest.mark.parametrize("in_odom", [False, True])
def test_a_goal_that_was_seen_stays_in_odometrys_frame(
    obedient: MakeObedient, run_move: RunMove, in_odom: bool
) -> None:
    """Localization corrects itself by 0.2 m on the way."""
    base = _base(obedient, Pose2D(2.0, 3.0, 0.0))
    goal = Pose2D(4.0, 3.0, 0.0)
    odom_from_goal = base.map_from_odom().inverse() @ goal
    to = Destination(lambda: [Stand(goal, 0, 0.0)], TOLERANCE, in_odom=in_odom)

    def correct() -> None:
        if base.at.x > 0.3:
            base.shift = Pose2D(0.0, 0.2, 0.0)

    run_move(travel(base, _mppi(base), to, recovery=False), correct)
    in_odometry = base.at.distance_to(odom_from_goal)
    in_map = base.pose().distance_to(goal)
    assert (in_odometry if in_odom else in_map) <= TOLERANCE[0]
    assert (in_map if in_odom else in_odometry) > 0.1


@pytest.mark.parametrize(("recovery", "times"), [(False, 0), (True, 3)])
def test_a_goal_in_a_wall_is_tried_as_often_as_allowed(
    obedient: MakeObedient,
    run_move: RunMove,
    recovery: bool,
    times: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    recovered: list[int] = []
    original = trip._recover

    def counted(vehicle: Any, attempt: int) -> Any:
        recovered.append(attempt)
        return original(vehicle, attempt)

    monkeypatch.setattr(trip, "_recover", counted)
    base = _base(obedient, Pose2D(2.0, 3.0, 0.0), (5.0, 2.0, 6.0, 4.0))
    assert _code(base, run_move, _to(Pose2D(5.5, 3.0, 0.0)), recovery=recovery) == "GOAL_BLOCKED"
    assert recovered == list(range(times))
    assert base.now() < 60.0


def test_a_room_without_a_door_is_no_path(obedient: MakeObedient, run_move: RunMove) -> None:
    base = _base(obedient, Pose2D(2.0, 3.0, 0.0), (3.9, 0.0, 4.1, 6.0))
    assert _code(base, run_move, _to(Pose2D(6.0, 3.0, 0.0)), recovery=False) == "NO_PATH"


def test_a_base_that_does_not_come_along_makes_no_progress(
    obedient: MakeObedient, run_move: RunMove
) -> None:
    base = _base(obedient, Pose2D(1.5, 3.0, 0.0))
    base.stuck = True
    assert _code(base, run_move, _to(Pose2D(6.0, 3.0, 0.0)), recovery=False) == "NO_PROGRESS"
    assert base.caution.factors() is None  # no place on its way is to blame
    assert base.now() < 2.0 * base.config.patience


def test_where_it_was_held_up_it_looks_for_another_way(
    obedient: MakeObedient, run_move: RunMove
) -> None:
    """Two doorways; the nearer one is narrow, and the base does not get through."""
    walls = ((3.9, 0.0, 4.1, 0.8), (3.9, 1.3, 4.1, 4.5), (3.9, 5.4, 4.1, 6.0))
    base = _base(obedient, Pose2D(2.0, 2.0, 0.0), *walls)
    held_at: list[float] = []

    def hold() -> None:
        pose = base.pose()
        ahead = abs(pose.yaw) < 0.7 and base.phases[-1:] == ["drive"]
        base.stuck = ahead and pose.y < 2.0 and pose.x > 3.5
        if base.stuck:
            held_at.append(base.now())

    run_move(travel(base, _mppi(base), _to(Pose2D(6.0, 2.0, 0.0)), recovery=True), hold)
    assert base.pose().distance_to(Pose2D(6.0, 2.0)) <= TOLERANCE[0]
    assert base.config.patience - 1.0 < held_at[-1] - held_at[0] < 2.0 * base.config.patience


def test_where_there_is_no_other_way_it_tries_the_same_again(
    obedient: MakeObedient, run_move: RunMove
) -> None:
    base = _base(obedient, Pose2D(2.0, 3.0, 0.0), *DOOR)

    def hold() -> None:
        base.stuck = base.pose().x > 3.5 and base.now() < 12.0 and base.phases[-1:] == ["drive"]

    run_move(travel(base, _mppi(base), _to(Pose2D(6.0, 3.0, 0.0)), recovery=True), hold)
    assert base.pose().distance_to(Pose2D(6.0, 3.0)) <= TOLERANCE[0]
    assert base.now() > 12.0


def test_a_trip_without_recovery_leaves_no_base_held(
    obedient: MakeObedient, run_move: RunMove
) -> None:
    base = _base(obedient, Pose2D(2.0, 3.0, 0.0))
    held_at: list[float] = []

    def hold() -> None:
        base.stuck = base.pose().x > 3.5 and base.phases[-1:] == ["drive"]
        if base.stuck:
            base.v = 0.0
            held_at.append(base.pose().x)

    with pytest.raises(Failure, match="NO_PROGRESS"):
        run_move(travel(base, _mppi(base), _to(Pose2D(6.0, 3.0, 0.0)), recovery=False), hold)
    assert held_at[-1] - base.pose().x == pytest.approx(trip.BACK, abs=0.05)
    assert base.stands()


@pytest.mark.parametrize("belief", [Belief(sigma=0.3), Belief(quality=0.2), Belief(sigma=0.14)])
def test_without_knowing_where_it_is_it_does_not_drive(
    obedient: MakeObedient, run_move: RunMove, belief: Belief
) -> None:
    base = _base(obedient, Pose2D(2.0, 3.0, 0.0), belief=belief)
    assert _code(base, run_move, _to(Pose2D(4.0, 3.0, 0.0)), recovery=True) == "NOT_LOCALIZED"
    assert base.at == Pose2D(0.0, 0.0)


def test_it_waits_for_localization_a_little(obedient: MakeObedient, run_move: RunMove) -> None:
    base = _base(obedient, Pose2D(2.0, 3.0, 0.0), belief=Belief(quality=0.0))
    for _ in be_sure(base):
        if base.now() > 1.0:
            base.localization = Belief()
    assert 1.0 < base.now() < 1.5


def test_another_failure_is_not_recovered_from(obedient: MakeObedient, run_move: RunMove) -> None:
    base = _base(obedient, Pose2D(2.0, 3.0, 0.0))

    def stands() -> list[Stand]:
        raise Failure("BAD_GOAL", "no such place")

    assert _code(base, run_move, Destination(stands, TOLERANCE), recovery=True) == "BAD_GOAL"
    assert base.now() < 1.0


def _doubts(base: Any, begins: float, ends: Callable[[Any], bool]) -> Callable[[], None]:
    """Be unsure from `begins` m on, until `ends`."""
    doubting = False

    def follow() -> None:
        nonlocal doubting
        begun = base.at.x > begins and not doubting
        if begun:
            doubting, base.localization = True, Belief(quality=0.5)
        elif doubting and ends(base):
            base.localization = Belief()

    return follow


def test_a_base_that_gets_lost_stops_and_says_so(obedient: MakeObedient, run_move: RunMove) -> None:
    base = _base(obedient, Pose2D(1.5, 3.0, 0.0))
    follow = _doubts(base, 0.5, lambda base: False)
    with pytest.raises(Failure, match="anywhere within") as caught:
        run_move(travel(base, _mppi(base), _to(Pose2D(7.0, 3.0, 0.0)), recovery=True), follow)
    assert caught.value.code == "NOT_LOCALIZED"
    assert base.stands()
    assert base.at.x < 0.5 + trip.LOST * base.limits.linear + 1.0


@pytest.mark.parametrize("at_rest", [True, False])
def test_a_doubt_that_passes_does_not_end_the_trip(
    obedient: MakeObedient, run_move: RunMove, at_rest: bool
) -> None:
    base = _base(obedient, Pose2D(1.5, 3.0, 0.0))
    goal = Pose2D(7.0, 3.0, 0.0)
    follow = _doubts(base, 0.5, lambda base: base.stands() if at_rest else base.at.x > 0.8)
    run_move(travel(base, _mppi(base), _to(goal), recovery=False), follow)
    assert base.pose().distance_to(goal) <= TOLERANCE[0]
    assert ("localize" in base.phases) == at_rest


def test_who_doubts_again_and_again_gives_up(obedient: MakeObedient, run_move: RunMove) -> None:
    base = _base(obedient, Pose2D(1.5, 3.0, 0.0))

    def follow() -> None:
        base.localization = Belief() if base.stands() else Belief(sigma=0.4)

    with pytest.raises(Failure, match=f"stopped {trip.DOUBTS} times") as caught:
        run_move(travel(base, _mppi(base), _to(Pose2D(7.0, 3.0, 0.0)), recovery=True), follow)
    assert caught.value.code == "NOT_LOCALIZED"
    assert base.stands()

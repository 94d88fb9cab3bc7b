"""An omnidirectional base glides to a pose, drives around obstacles, and stops before them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.control import glide
from momantu_skills.navigation.control.guard import safe_share
from momantu_skills.navigation.control.mppi import Mppi
from momantu_skills.navigation.drive.manoeuvre import approach_is_sure, run_in
from momantu_skills.navigation.drive.trip import Destination, travel
from momantu_skills.navigation.plan.goals import Stand

from momantu_bt.geometry import Pose2D
from momantu_bt.robot import BaseKind, BaseLimits
from tests.skills.scenery.obedient import LIMITS, MakeObedient, RunMove

OMNI = LIMITS.model_copy(update={"kind": BaseKind.OMNIDIRECTIONAL})
DISC = np.array([[0.0, 0.0, 0.3]])
REST = (0.0, 0.0, 0.0)
OFFSETS = st.builds(Pose2D, st.floats(-0.8, 0.8), st.floats(-0.8, 0.8), st.floats(-1.5, 1.5))


class Belief:
    """A localization that is sure."""

    covariance, quality = np.eye(3) * 1e-4, 1.0


@settings(max_examples=30)
@given(OFFSETS)
def test_it_glides_to_the_goal_from_every_side(
    obedient: MakeObedient, run_move: RunMove, offset: Pose2D
) -> None:
    goal = Pose2D(4.0, 3.0, 0.7)
    base = obedient(goal @ offset, limits=OMNI)
    assert approach_is_sure(base, goal, 0.05)
    assert run_move(run_in(base, lambda: goal))
    run_move(base.stop("stop"))
    end = goal.inverse() @ base.pose()
    assert math.hypot(end.x, end.y) < 0.025
    assert abs(end.yaw) < 0.05


def test_beside_a_goal_it_neither_turns_nor_backs(
    obedient: MakeObedient, run_move: RunMove
) -> None:
    goal = Pose2D(4.0, 3.0, 0.0)
    base = obedient(Pose2D(4.0, 2.6, 0.0), limits=OMNI)
    assert approach_is_sure(base, goal, 0.05)
    run_move(run_in(base, lambda: goal))
    assert base.time < 4.0
    assert abs(base.pose().yaw) < 0.02


def test_a_differential_base_is_never_sent_sideways(
    obedient: MakeObedient, run_move: RunMove
) -> None:
    """`Obedient` fails if it is."""
    base = obedient(Pose2D(4.0, 2.6, 0.0))
    assert not approach_is_sure(base, Pose2D(4.0, 3.0, 0.0), 0.05)


def test_it_does_not_glide_through_what_was_seen(obedient: MakeObedient) -> None:
    base = obedient(Pose2D(4.0, 1.8, 0.0), ((3.5, 2.35, 4.5, 2.45),), limits=OMNI)
    assert not approach_is_sure(base, Pose2D(4.0, 3.0, 0.0), 0.05)


def test_it_stops_gliding_when_something_appears(obedient: MakeObedient, run_move: RunMove) -> None:
    goal = Pose2D(4.0, 3.0, 0.0)
    base = obedient(Pose2D(4.0, 1.8, 0.0), limits=OMNI)
    moving = run_in(base, lambda: goal)
    for _ in range(5):
        next(moving)
    base.costmap = obedient(base.pose(), ((3.5, 2.55, 4.5, 2.65),), limits=OMNI).costmap
    assert run_move(moving) is False
    assert base.least > 0.0


STARTS = st.builds(Pose2D, st.floats(0.8, 3.0), st.floats(0.8, 5.2), st.floats(-3.1, 3.1))
GOALS = st.builds(Pose2D, st.floats(5.0, 7.0), st.floats(0.8, 5.2), st.floats(-3.1, 3.1))


@settings(max_examples=8)
@given(STARTS, GOALS)
def test_a_trip_through_a_door_arrives_without_touching(
    obedient: MakeObedient, run_move: RunMove, start: Pose2D, goal: Pose2D
) -> None:
    base = obedient(start, ((3.9, 0.0, 4.1, 2.4), (3.9, 3.6, 4.1, 6.0)), limits=OMNI)
    base.localization = Belief()
    to = Destination(lambda: [Stand(goal, 0, 0.0)], (0.05, 0.05))
    mppi = Mppi(OMNI, NavigationConfig(), np.random.default_rng(0))
    run_move(travel(base, mppi, to, recovery=True))
    end = goal.inverse() @ base.pose()
    assert math.hypot(end.x, end.y) < 0.05
    assert abs(end.yaw) < 0.05
    assert base.least > 0.0


@given(st.floats(-0.3, 0.3), st.floats(-0.8, 0.8), st.floats(0.33, 1.5), st.floats(-3.1, 3.1))
def test_what_the_guard_lets_through_can_still_stop(
    v: float, u: float, away: float, bearing: float
) -> None:
    hit = np.array([[away * math.cos(bearing), away * math.sin(bearing)]])
    share = safe_share((v, 0.0, u), REST, OMNI, DISC, hit)
    speed = np.zeros(2)
    at = np.zeros(2)
    for k in range(250):
        wanted = share * np.array([v, u]) if k < 10 else np.zeros(2)
        speed += np.clip(wanted - speed, -0.01, 0.01)
        at += 0.01 * speed
    assert math.hypot(*(hit[0] - at)) > 0.3 - 0.005 or share == 0.0


def test_the_law_keeps_to_the_limits_of_every_direction() -> None:
    slow = BaseLimits(
        kind=BaseKind.OMNIDIRECTIONAL,
        linear=0.5,
        lateral=0.2,
        angular=1.0,
        linear_acceleration=1.0,
        angular_acceleration=1.0,
    )
    for bearing in np.linspace(-3.1, 3.1, 40):
        goal = Pose2D(2.0 * math.cos(bearing), 2.0 * math.sin(bearing), 2.0)
        wanted = glide.command(Pose2D(0.0, 0.0), goal, slow)
        assert wanted is not None
        linear, angular, lateral = wanted
        assert -glide.SIDE_SPEED - 1e-9 <= linear <= 0.5 + 1e-9
        assert abs(lateral) <= 0.2 + 1e-9
        assert 0.0 < angular <= 1.0
        assert math.atan2(lateral, linear) == pytest.approx(bearing)
    assert glide.command(goal, goal, slow) is None

"""GoalReached, ArePosesNear, GetCurrentPose, RemovePassedGoals."""

from typing import Any

import pytest
from momantu_skills.nav2.goal_checks import (
    ArePosesNear,
    GetCurrentPose,
    GoalReached,
    RemovePassedGoals,
)

from momantu_bt.claim import BaseNear
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import WaypointStatus
from tests.skills.nav2.conftest import Act
from tests.skills.scenery.flat import START, Flat

NEAR, FAR = Pose2D(-1.9, 0.1, 2.0), Pose2D(-1.0, 0.0)


@pytest.mark.parametrize(
    ("goal", "code"),
    [(NEAR, None), (FAR, "NOT_REACHED"), ("left", "NOT_REACHED"), ("x", "BAD_GOAL")],
)
def test_goal_reached_within_a_quarter_of_a_metre(
    flat: Flat, act: Act, goal: Any, code: str | None
) -> None:
    result = act(GoalReached, flat(START), goal=goal)
    assert result.code == code
    assert isinstance(result.claim(), BaseNear) is (code is None)


@pytest.mark.parametrize(
    ("other", "tolerance", "code"),
    [(FAR, 1.0, None), (FAR, 0.5, "NOT_NEAR"), ("kitchen", 0.5, "BAD_GOAL")],
)
def test_poses_near(flat: Flat, act: Act, other: Any, tolerance: float, code: str | None) -> None:
    inputs = {"ref_pose": NEAR, "target_pose": other, "tolerance": tolerance}
    assert act(ArePosesNear, flat(), **inputs).code == code


def test_the_current_pose(flat: Flat, act: Act) -> None:
    pose = act(GetCurrentPose, flat(START)).outputs["current_pose"]
    assert pose.distance_to(START) < 0.05
    assert act(GetCurrentPose, flat(), global_frame="odom").code == "WRONG_FRAME"


def test_passed_goals_are_removed_in_their_order(flat: Flat, act: Act) -> None:
    goals = (NEAR, START, FAR, NEAR)
    result = act(RemovePassedGoals, flat(START), input_goals=goals)
    assert result.outputs["output_goals"] == (FAR, NEAR)
    statuses = result.outputs["output_waypoint_statuses"]
    assert [status.waypoint_status for status in statuses] == [1, 1, 0, 0]


def test_the_last_goal_stays(flat: Flat, act: Act) -> None:
    result = act(RemovePassedGoals, flat(START), input_goals=(START,))
    assert result.outputs["output_goals"] == (START,)
    assert act(RemovePassedGoals, flat(START)).outputs["output_goals"] == ()


def test_no_status_and_bad_goal(flat: Flat, act: Act) -> None:
    statuses = (WaypointStatus(0, 0, FAR),)
    goals = (START, FAR)
    result = act(
        RemovePassedGoals, flat(START), input_goals=goals, input_waypoint_statuses=statuses
    )
    assert result.code == "NO_STATUS"
    assert act(RemovePassedGoals, flat(), input_goals=("kitchen", FAR)).code == "BAD_GOAL"

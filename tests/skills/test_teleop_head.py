"""teleop_head: it turns the head within its limits, and stands still when nobody commands."""

from __future__ import annotations

from typing import Any

import pytest
from momantu_skills.controls import rehearsed
from momantu_skills.teleop_head import TeleopHead

from momantu_bt.teleoperation import Command, OperatorService
from momantu_bt.testing import ScriptedRobot, eye_in_hand_robot, run_skill


def turn(wanted: Any, robot: ScriptedRobot, seconds: float = 2.0, **more: Any) -> Any:
    return run_skill(TeleopHead, robot=robot, services=rehearsed(wanted, seconds), **more)


def test_without_a_person_it_fails_with_no_operator() -> None:
    result = run_skill(TeleopHead, services={"operator": OperatorService()})
    assert result.code == "NO_OPERATOR"


def test_it_turns_at_the_commanded_speed_and_stops_on_release() -> None:
    robot = ScriptedRobot()
    result = turn(lambda now: Command(now, joints={"pan": 0.4} if now < 1.0 else {}), robot)
    assert result.status == "SUCCESS", result.explain()
    assert robot.joints["pan"] == pytest.approx(0.4, abs=0.05)
    assert robot.joints["tilt"] == 0.0
    assert result.phases[:3] == ("standing", "turning", "standing")


def test_it_stops_at_the_limit_and_says_which_joint() -> None:
    robot = ScriptedRobot()
    result = turn(lambda now: Command(now, joints={"tilt": 50.0}), robot)
    limit = robot.description.joint_limits["tilt"]
    assert robot.joints["tilt"] == pytest.approx(limit.upper)
    assert "stopped: tilt is at its limit" in result.phases


def test_it_says_when_the_head_does_not_follow() -> None:
    robot = ScriptedRobot()
    robot.frozen.add("head")
    result = turn(lambda now: Command(now, joints={"pan": 0.5}), robot)
    assert "stopped: pan does not follow" in result.phases


def test_stop_halts_it_at_once() -> None:
    robot = ScriptedRobot()
    robot_at: list[float] = []
    turn(
        lambda now: Command(now, joints={"pan": 0.5} if now < 0.5 else {}, stop=0.5 <= now < 0.56),
        robot,
        on_tick=lambda session, world: robot_at.append(robot.joints["pan"]),
    )
    assert robot_at[-1] == pytest.approx(robot_at[11], abs=0.03)
    assert robot.commands[-1][2] is None


def test_a_camera_on_the_arm_is_left_to_the_arm() -> None:
    robot = ScriptedRobot(eye_in_hand_robot())
    result = turn(lambda now: Command(now, joints={"shoulder": 0.5}), robot)
    assert (result.status, robot.commands) == ("SUCCESS", [])

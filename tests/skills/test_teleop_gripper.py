"""teleop_gripper: it opens and closes as commanded, holds what it has, and limits its force."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from momantu_skills.controls import rehearsed
from momantu_skills.teleop_gripper import TeleopGripper

from momantu_bt.messages import GripperCommand
from momantu_bt.teleoperation import Command, OperatorService
from momantu_bt.testing import ScriptedRobot, run_skill


class Scene:
    """Knows whether something is held."""

    def __init__(self, held: object = None) -> None:
        self.held, self.last_contact = held, 0.0

    def released(self) -> None:
        self.held = None


def grip(
    wanted: Any, robot: ScriptedRobot, scene: Scene | None = None, seconds: float = 2.0
) -> Any:
    services = {"planning_scene": scene or Scene(), **rehearsed(wanted, seconds)}
    return run_skill(TeleopGripper, robot=robot, services=services)


def closing_until(end: float) -> Any:
    return lambda now: Command(now, opening=0.0 if now < end else None)


def test_without_a_person_it_fails_with_no_operator() -> None:
    services = {"planning_scene": Scene(), "operator": OperatorService()}
    result = run_skill(TeleopGripper, services=services)
    assert result.code == "NO_OPERATOR"


def test_it_closes_as_long_as_it_is_told_and_stays_where_it_is() -> None:
    robot = ScriptedRobot()
    result = grip(closing_until(0.5), robot)
    assert result.status == "SUCCESS", result.explain()
    assert result.phases == ("closing", "standing")
    assert robot.gripper_width == pytest.approx(0.05, abs=0.011)
    assert robot.gripper_effort == 0.0


def test_what_it_presses_on_it_goes_on_holding_within_the_force_limit() -> None:
    robot = ScriptedRobot()
    robot.object_width = 0.06
    result = grip(closing_until(1.0), robot)
    assert result.phases == ("closing", "pressing on something")
    assert robot.gripper_effort > 0.0
    forces = [g.max_force for _, _, g in robot.commands if isinstance(g, GripperCommand)]
    assert forces
    assert max(forces) <= robot.description.end_effector.max_force


def test_opening_releases_what_is_held() -> None:
    robot, scene = ScriptedRobot(gripper_width=0.04), Scene(SimpleNamespace())
    result = grip(lambda now: Command(now, opening=9.0), robot, scene)
    assert scene.held is None
    assert result.phases == ("opening", "standing")
    assert robot.gripper_width == pytest.approx(robot.description.end_effector.max_width)


def test_without_a_command_nothing_is_sent() -> None:
    robot = ScriptedRobot()
    grip(lambda now: Command(now), robot)
    assert [goal for _, _, goal in robot.commands if goal is not None] == []

"""release: the hand ends open and empty, or the skill says that it does not open."""

from __future__ import annotations

from typing import Any

import pytest
from momantu_skills.release import Release

from momantu_bt.claim import GripperOpen, Holding
from momantu_bt.geometry import Transform
from momantu_bt.testing import run_skill


def release(robot: Any, scene: Any) -> Any:
    services = {"planning_scene": scene}
    return run_skill(Release, robot=robot, services=services, frames=scene.frames)


def test_what_was_held_is_let_go(tabletop: Any, scene_of: Any) -> None:
    robot = tabletop(pose="carry")
    thing = robot.detected()
    robot.hold(Transform())
    robot.advance(0.05)
    scene = scene_of(robot)
    scene.grasped(thing, Transform())
    scene.holding.last_contact = -1.0
    result = release(robot, scene)
    assert result.status == "SUCCESS", result.explain()
    assert robot.gripper_width == pytest.approx(0.1, abs=0.01)
    assert scene.held is None
    assert scene.last_contact > -1.0


def test_an_open_hand_stays_open_and_has_touched_nothing(tabletop: Any, scene_of: Any) -> None:
    robot = tabletop()
    scene = scene_of(robot)
    result = release(robot, scene)
    assert result.status == "SUCCESS", result.explain()
    assert scene.last_contact == float("-inf")
    assert result.duration < 1.0


def test_a_gripper_that_does_not_open_is_stuck(tabletop: Any, scene_of: Any) -> None:
    robot = tabletop()
    robot.gripper_width = 0.03
    robot.frozen.add("gripper")
    result = release(robot, scene_of(robot))
    assert result.code == "GRIPPER_STUCK"
    assert "30 mm of 100 mm" in result.failure.message


@pytest.mark.parametrize("stuck", [False, True])
def test_an_open_and_empty_hand_is_claimed_whether_said_or_denied(
    tabletop: Any, scene_of: Any, stuck: bool
) -> None:
    robot = tabletop()
    robot.gripper_width = 0.03
    robot.frozen |= {"gripper"} if stuck else set()
    result = release(robot, scene_of(robot))
    assert (result.code == "GRIPPER_STUCK") is stuck
    opened, empty = result.claim()
    assert isinstance(opened, GripperOpen)
    assert (robot.gripper_width >= opened.width) is not stuck
    assert empty == Holding(False)

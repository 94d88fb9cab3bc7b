"""release: the hand ends open and empty, or the skill says that it does not open."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest
from momantu_skills.manipulation.scene.surroundings import Surroundings
from momantu_skills.release import Release

from momantu_bt.claim import GripperOpen, Holding
from momantu_bt.geometry import Transform
from momantu_bt.testing import run_skill
from tests.skills.scenery.table import SceneOf, Tabletop


def release(robot: Any, scene: Any, **inputs: Any) -> Any:
    services = {"planning_scene": scene}
    return run_skill(Release, robot=robot, services=services, frames=scene.frames, inputs=inputs)


def test_what_was_held_is_let_go(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
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


def test_an_open_hand_stays_open_and_has_touched_nothing(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop()
    scene = scene_of(robot)
    result = release(robot, scene)
    assert result.status == "SUCCESS", result.explain()
    assert scene.last_contact == float("-inf")
    assert result.duration < 1.0


def test_a_gripper_that_does_not_open_is_stuck(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop()
    robot.gripper_width = 0.03
    robot.frozen.add("gripper")
    result = release(robot, scene_of(robot))
    assert result.code == "GRIPPER_STUCK"
    assert "30 mm of 100 mm" in result.failure.message


@pytest.mark.parametrize("stuck", [False, True])
def test_an_open_and_empty_hand_is_claimed_whether_said_or_denied(
    tabletop: type[Tabletop], scene_of: SceneOf, stuck: bool
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


def test_the_open_hand_draws_back_along_its_fingers(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop(can=None)
    before = robot.odom_from_hand
    result = release(robot, scene_of(robot), back=0.1)
    assert result.status == "SUCCESS", result.explain()
    moved = before.inverse() @ robot.odom_from_hand
    assert moved.position == pytest.approx((-0.1, 0.0, 0.0), abs=0.01)
    assert before.angle_to(robot.odom_from_hand) < 0.05


def test_it_stays_where_it_is_without_being_asked(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop(can=None)
    before = robot.odom_from_hand
    release(robot, scene_of(robot))
    assert before.position == pytest.approx(robot.odom_from_hand.position, abs=1e-6)


def test_it_does_not_draw_back_into_something(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop(can=None)
    scene = scene_of(robot)
    before = robot.odom_from_hand
    x, y, z = (before @ Transform((-0.35, 0.0, 0.0))).position
    block = [(x + i, y + j, z + k) for i, j, k in product(np.arange(-0.1, 0.1, 0.02), repeat=3)]
    scene.scene.surroundings = Surroundings(np.array(block))
    result = release(robot, scene, back=0.1)
    assert result.status == "SUCCESS", result.explain()
    assert before.position == pytest.approx(robot.odom_from_hand.position, abs=1e-6)


def test_an_arm_that_does_not_come_along_is_stuck(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop(can=None)
    robot.frozen.add("arm")
    assert release(robot, scene_of(robot), back=0.1).code == "ARM_STUCK"

"""Before the base drives, an arm that was stretched out to look is taken in."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import pytest
from momantu_skills.gaze.tucking import STICKS_OUT, take_in
from momantu_skills.manipulation.scene.surroundings import Surroundings

from momantu_bt.geometry import Pose, Transform
from momantu_bt.messages import DetectedObject, GripperCommand
from momantu_bt.robot import CAMERA_CARRIER, Robot
from momantu_bt.skill import Needs, Run, Skill
from momantu_bt.testing import ScriptedRobot, eye_in_hand_robot, run_skill
from momantu_bt.testing.painting import Painter
from tests.skills.scenery.table import SceneOf

STRETCHED = (0.0, 2.0, 3.14, 0.0, 0.0, 0.0)
CAN = DetectedObject("can", Pose(Transform(), "odom", 0.0), (0.07, 0.07, 0.13), "cylinder", 1.0, 0)


class TakeIn(Skill):
    """What driving skills do first."""

    failures: ClassVar = {"ARM_STUCK": "the arm does not follow"}
    uses: ClassVar = {CAMERA_CARRIER}
    planning_scene: Any = Needs()

    def run(self, robot: Robot) -> Run:
        yield from take_in(self, robot, self.planning_scene)


def robot_at(posture: Any) -> ScriptedRobot:
    description = eye_in_hand_robot()
    joints = dict(zip(description.groups["arm"].joints, posture, strict=True))
    return ScriptedRobot(description, joints=joints, readings={"camera": Painter([])})


def run(robot: ScriptedRobot, scene: Any) -> Any:
    services = {"planning_scene": scene}
    return run_skill(TakeIn, robot=robot, services=services, frames=scene.frames)


def off(robot: ScriptedRobot, pose: str) -> float:
    wanted = robot.description.named_poses[pose]
    turned = [(robot.joints[name] - value) / (2 * np.pi) for name, value in wanted.items()]
    return max(abs(t - round(t)) for t in turned) * 2 * np.pi


def outside(robot: ScriptedRobot, scene: Any) -> float:
    """How far arm and load reach beyond the base's outline, m."""
    reach = np.abs(scene.footprint(robot.state())).max(axis=0)
    return float((reach - np.abs(robot.description.footprint).max(axis=0)).max())


def test_a_stretched_arm_goes_home_and_what_it_holds_is_carried(scene_of: SceneOf) -> None:
    for load, pose in ((None, "home"), (CAN, "carry")):
        robot = robot_at(STRETCHED)
        scene = scene_of(robot)
        if load is not None:
            robot.object_width = robot.gripper_width = 0.07
            robot.command("gripper", GripperCommand(0.04, 40.0))
            robot.advance(0.05)
            scene.update(robot, robot.time)
            scene.grasped(load, Transform())
        assert outside(robot, scene) > STICKS_OUT
        result = run(robot, scene)
        assert result.status == "SUCCESS", result.explain()
        assert off(robot, pose) < 0.02
        assert outside(robot, scene) < STICKS_OUT
        assert (scene.held is None) == (load is None)


@pytest.mark.parametrize("pose", ["home", "ready", "carry", "look_around"])
def test_an_arm_that_is_in_stays(scene_of: SceneOf, pose: str) -> None:
    description = eye_in_hand_robot()
    robot = robot_at(description.named_poses[pose].values())
    assert run(robot, scene_of(robot)).status == "SUCCESS"
    assert robot.commands == []


def test_without_a_way_the_base_drives_with_the_arm_as_it_is(scene_of: SceneOf) -> None:
    robot = robot_at(STRETCHED)
    scene = scene_of(robot)
    cells = np.stack(np.meshgrid(*[np.arange(-0.1, 0.1, 0.02)] * 3), axis=-1).reshape(-1, 3)
    scene.scene.surroundings = Surroundings(cells + np.array((0.0, 0.15, 0.43)))
    before = dict(robot.joints)
    assert run(robot, scene).status == "SUCCESS"
    assert robot.joints == before


def test_an_arm_that_does_not_move_is_no_load_to_drive_with(scene_of: SceneOf) -> None:
    robot = robot_at(STRETCHED)
    robot.frozen.add("arm")
    assert run(robot, scene_of(robot)).code == "ARM_STUCK"

"""examine_hand: what a check cannot tell is found out by looking, pressing and lifting."""

from __future__ import annotations

from typing import Any

import pytest
from momantu_skills.check import Check
from momantu_skills.examine_hand import LIFT, ExamineHand

from momantu_bt.claim import Holding
from momantu_bt.geometry import Transform
from momantu_bt.messages import GripperCommand
from momantu_bt.testing import run_skill
from tests.skills.scenery.table import SceneOf, Tabletop


def examine(robot: Any, scene: Any, skill: Any = ExamineHand, **inputs: Any) -> Any:
    services = {"planning_scene": scene, "localization": object()}
    return run_skill(skill, robot=robot, services=services, frames=scene.frames, inputs=inputs)


def settled(robot: Tabletop, scene_of: SceneOf) -> Any:
    """A planning scene that has read the fingers for a while."""
    scene = scene_of(robot)
    for _ in range(8):
        robot.advance(0.05)
        scene.frames.add_state(robot.state())
        scene.update(robot, robot.time)
    return scene


class Jammed(Tabletop):
    """Its fingers press, and do not close: on something, or because they are jammed at 50 mm."""

    stopped_at = 0.05

    def advance(self, seconds: float) -> None:
        super().advance(seconds)
        if self.hand_from_can is None:
            self.object_width = self.stopped_at


@pytest.fixture
def jammed() -> Jammed:
    robot = Jammed(can=None, pose="carry")
    robot.object_width = robot.gripper_width = 0.05
    robot.command("gripper", GripperCommand(0.0, 45.0))
    return robot


def test_what_is_known_moves_nothing(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop(pose="carry")
    robot.hold(Transform())
    commands = len(robot.commands)
    result = examine(robot, settled(robot, scene_of))
    assert result.outputs["holding"] is True
    assert result.claim() == Holding(True)
    assert len(robot.commands) == commands
    assert not result.phases or set(result.phases) <= {"feeling", ""}


def test_jammed_fingers_are_looked_at_and_lifted(jammed: Jammed, scene_of: SceneOf) -> None:
    """Nothing weighs in the hand, and the picture shows nothing in it."""
    scene = settled(jammed, scene_of)
    before = jammed.odom_from_hand.position[2]
    result = examine(jammed, scene)
    assert result.code in (None, "HOLDING_UNKNOWN"), result.explain()
    assert result.outputs.get("holding", False) is False
    assert "look" in result.phases or jammed.odom_from_hand.position[2] > before + LIFT / 2


def test_a_hand_that_leans_is_lifted_and_weighed(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    """The table carries the can: its weight shows when the hand is higher."""
    robot = tabletop(can=None, pose="carry")
    z = robot.odom_from_hand.position[2]
    robot.table = z - 0.065 + 0.0013
    robot.can = Transform((*robot.odom_from_hand.position[:2], z))
    robot.hold(Transform())
    scene = settled(robot, scene_of)
    first = examine(robot, scene, Check, what="holding")
    assert first.code == "HOLDING_UNKNOWN", first.explain()
    result = examine(robot, scene)
    assert result.status == "SUCCESS", result.explain()
    assert result.outputs["holding"] is True
    assert "lifting" in result.phases
    assert examine(robot, scene, Check, what="holding").status == "SUCCESS"


def test_what_cannot_be_found_out_is_said(jammed: Jammed, scene_of: SceneOf) -> None:
    """The wrist is dead; what the fingers press on may be too small to be seen."""
    jammed.dead.add("wrench")
    result = examine(jammed, settled(jammed, scene_of))
    assert result.code == "HOLDING_UNKNOWN", result.explain()
    assert "tried: looking, pressing, lifting" in result.failure.message
    assert result.failure.data["tried"] == ["looking", "pressing", "lifting"]
    assert result.claim() is None


def test_an_arm_that_does_not_follow(jammed: Jammed, scene_of: SceneOf) -> None:
    jammed.frozen.add("arm")
    jammed.dead.add("wrench")
    result = examine(jammed, settled(jammed, scene_of))
    assert result.code == "ARM_STUCK", result.explain()
    assert result.claim() is None


def test_the_hand_is_never_opened(jammed: Jammed, scene_of: SceneOf) -> None:
    jammed.dead.add("wrench")
    told = len(jammed.commands)
    examine(jammed, settled(jammed, scene_of))
    goals = [goal for _, name, goal in jammed.commands[told:] if name == "gripper" and goal]
    assert goals
    assert all(goal.width == 0.0 for goal in goals)

"""teleop_gripper: a person opens and closes the gripper, with the force that the robot allows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from momantu_bt.messages import GripperCommand, RobotState
from momantu_bt.robot import Robot
from momantu_bt.skill import Needs, Run, Skill
from momantu_bt.teleoperation import Command, Operator
from momantu_skills.controls import OPERATED, commanded, rehearsed
from momantu_skills.manipulation.config import HandConfig
from momantu_skills.manipulation.hand.gripper import OPEN_TOLERANCE, PRESSING
from momantu_skills.manipulation.scene.arm_scene import ArmScene
from momantu_skills.manipulation.scene.service import PlanningSceneService


class TeleopGripper(Skill):
    """Open and close the gripper as a person commands, until the person leaves.

    Where the person lets go, the fingers stay; fingers that press on something go on pressing.
    """

    failures = {**OPERATED}
    uses: ClassVar = {"gripper"}
    activities: ClassVar = {}
    symptoms: ClassVar = {}
    operator: Operator = Needs()
    planning_scene: ArmScene = Needs()

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """The gripper closes."""
        services = rehearsed(lambda now: Command(now, opening=0.0))
        return {"services": {**services, "planning_scene": PlanningSceneService()}}

    def run(self, robot: Robot) -> Run:
        """Give the fingers their goal at each tick."""
        hand = robot.description.hand
        force = min(HandConfig().force, hand.max_force)
        goal: GripperCommand | None = None
        moving = False
        while not (command := commanded(self)).ended:
            state = robot.state()
            pressing = goal is not None and _presses(state, goal)
            if command.opening is not None:
                self._let_go(command.opening, state)
                width = min(max(command.opening, 0.0), hand.max_width)
                goal, moving = GripperCommand(width, force), True
            elif moving:
                moving = False
                if not pressing:
                    goal = GripperCommand(state.gripper_width, force)
            if goal is not None:
                robot.command(hand.actuator, goal)
            yield _phase(state, goal, moving, pressing)

    def _let_go(self, opening: float, state: RobotState) -> None:
        """Tell the planning scene of an object that the opening fingers release."""
        if opening > state.gripper_width and self.planning_scene.held is not None:
            self.planning_scene.released()


def _presses(state: RobotState, goal: GripperCommand) -> bool:
    """Whether the fingers press on something before they get to their goal."""
    pressing = state.gripper_effort > PRESSING * goal.max_force
    return pressing and goal.width < state.gripper_width


def _phase(state: RobotState, goal: GripperCommand | None, moving: bool, pressing: bool) -> str:
    if pressing:
        return "pressing on something"
    if goal is None or not moving or abs(state.gripper_width - goal.width) < OPEN_TOLERANCE:
        return "standing"
    return "opening" if goal.width > state.gripper_width else "closing"

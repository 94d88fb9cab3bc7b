"""Faulty grippers: they press too little, do not move, or let go."""

from __future__ import annotations

from momantu_bt.fault import Fault
from momantu_bt.faults.effects.robot.actuators import gripper_of
from momantu_bt.faults.effects.robot.layer import GoalLayer, StuckLayer
from momantu_bt.messages import ActuatorGoal, GripperCommand
from momantu_bt.robot import Robot

PRESSING = 1.0
"""Above this closing effort, N, the fingers hold something, or press on each other."""
OPENING = 1e-3
"""A goal means to open if it is wider than the present opening by this, m."""


class Weak(GoalLayer):
    """`gripper.weak`: a share of the force; a gripper that holds something keeps its force."""

    def find(self) -> str:
        """The gripper."""
        return gripper_of(self.description)

    def changed(self, goal: ActuatorGoal) -> ActuatorGoal:
        """The same opening with less force."""
        if not isinstance(goal, GripperCommand):
            return goal
        return GripperCommand(goal.width, goal.max_force * self.number("factor"))


class Stuck(StuckLayer):
    """`gripper.stuck`: fingers that press go on pressing, others stay where they are."""

    def find(self) -> str:
        """The gripper."""
        return gripper_of(self.description)

    def begin(self) -> None:
        """Hold the fingers where they are."""
        super().begin()
        state, effector = self.inner.state(), self.description.hand
        if state.gripper_effort <= PRESSING:
            width = max(0.0, min(effector.max_width, state.gripper_width))
            self.inner.command(self.actuator, GripperCommand(width, effector.max_force))


class Slips(GoalLayer):
    """`gripper.slips`: little force, until the fingers are commanded to open."""

    def __init__(self, inner: Robot, fault: Fault, seed: int) -> None:
        super().__init__(inner, fault, seed)
        self._last: GripperCommand | None = None

    def find(self) -> str:
        """The gripper."""
        return gripper_of(self.description)

    def begin(self) -> None:
        """Repeat the fingers' last command with little force."""
        super().begin()
        width = max(0.0, self.inner.state().gripper_width)
        last = self._last or GripperCommand(width, self.description.hand.max_force)
        self.inner.command(self.actuator, self._weakened(last))

    def command(self, actuator: str, goal: ActuatorGoal) -> None:
        """Pass the goal to the robot; a goal to open ends the fault."""
        if actuator == self.actuator and isinstance(goal, GripperCommand):
            if goal.width > self.inner.state().gripper_width + OPENING:
                self.active = False
            self._last = goal
        super().command(actuator, goal)

    def changed(self, goal: ActuatorGoal) -> ActuatorGoal:
        """The same opening with the remaining force."""
        return self._weakened(goal) if isinstance(goal, GripperCommand) else goal

    def _weakened(self, goal: GripperCommand) -> GripperCommand:
        return GripperCommand(goal.width, min(goal.max_force, self.number("force")))

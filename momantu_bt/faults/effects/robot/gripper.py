"""Faulty grippers: they press too little, do not move, or let go."""

from __future__ import annotations

from momantu_bt.fault import Fault
from momantu_bt.faults.effects.robot.actuators import gripper_of
from momantu_bt.faults.effects.robot.layer import GoalLayer, StuckLayer
from momantu_bt.messages import ActuatorGoal, GripperCommand
from momantu_bt.robot import Robot

PRESSING = 1.0
"""N of closing effort above which the fingers hold something, or each other."""
OPENING = 1e-3
"""m beyond the present opening that make a goal one to open."""


class Weak(GoalLayer):
    """`gripper.weak`: a share of the force; what holds something goes on with what it has."""

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
        state, effector = self.inner.state(), self.description.end_effector
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
        last = self._last or GripperCommand(width, self.description.end_effector.max_force)
        self.inner.command(self.actuator, self._weakened(last))

    def command(self, actuator: str, goal: ActuatorGoal) -> None:
        """Give it to the robot; opening ends the fault."""
        if actuator == self.actuator and isinstance(goal, GripperCommand):
            if goal.width > self.inner.state().gripper_width + OPENING:
                self.active = False
            self._last = goal
        super().command(actuator, goal)

    def changed(self, goal: ActuatorGoal) -> ActuatorGoal:
        """The same opening with what force is left."""
        return self._weakened(goal) if isinstance(goal, GripperCommand) else goal

    def _weakened(self, goal: GripperCommand) -> GripperCommand:
        return GripperCommand(goal.width, min(goal.max_force, self.number("force")))

"""A wheel that is larger than the driver believes: the base drives elsewhere than odometry says."""

from __future__ import annotations

from momantu_bt.fault import Fault
from momantu_bt.faults.effects.robot.actuators import base_of
from momantu_bt.faults.effects.robot.odometry import OdometryLayer
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import ActuatorGoal, BaseVelocity, RobotState
from momantu_bt.robot import BaseKind, Robot
from momantu_bt.wheels import Wheels, between_wheels, within_limits

SIDES = ("left", "right")


class Larger(OdometryLayer):
    """`base.wheel`: the base pulls to the other side, and odometry counts straight on.

    Raises KeyError if the base has no two sides, or the parameter names neither.
    """

    def __init__(self, inner: Robot, fault: Fault, seed: int) -> None:
        super().__init__(inner, fault, seed)
        self.actuator = base_of(self.description)
        side, factor = str(fault.parameters["side"]), self.number("factor") - 1.0
        if self.description.base.kind is not BaseKind.DIFFERENTIAL:
            raise KeyError(f"its base is {self.description.base.kind}, without a left wheel")
        if side not in SIDES:
            raise KeyError(f"no side is called {side!r}; a base has: {', '.join(SIDES)}")
        left, right = (factor, 0.0) if side == "left" else (0.0, factor)
        self._wheels = Wheels(left, right, 0.0, between_wheels(self.description))

    def moved(self, moved: Pose2D, seconds: float, moving: bool) -> Pose2D:
        """As the believed wheels would have."""
        return self._wheels.told_step(moved)

    def speeds(self, now: RobotState, moving: bool) -> tuple[float, float, float]:
        """Those of the believed wheels."""
        return (*self._wheels.told(now.linear, now.angular), now.lateral)

    def command(self, actuator: str, goal: ActuatorGoal) -> None:
        """Give the base the speeds that its true wheels make of these."""
        if self.active and actuator == self.actuator and isinstance(goal, BaseVelocity):
            true = BaseVelocity(*self._wheels.true(goal.linear, goal.angular))
            goal = within_limits(self.description, true, goal)
        self.inner.command(actuator, goal)

"""Faulty bases: they do not move as commanded."""

from __future__ import annotations

from momantu_bt.faults.effects.robot.actuators import base_of
from momantu_bt.faults.effects.robot.layer import GoalLayer, StuckLayer
from momantu_bt.messages import ActuatorGoal, BaseVelocity


class Stuck(StuckLayer):
    """`base.stuck`."""

    def find(self) -> str:
        """The base."""
        return base_of(self.description)


class Slow(GoalLayer):
    """`base.slow`: both speeds are scaled."""

    def find(self) -> str:
        """The base."""
        return base_of(self.description)

    def changed(self, goal: ActuatorGoal) -> ActuatorGoal:
        """The slower goal; the driver refuses a goal that is not a speed."""
        if not isinstance(goal, BaseVelocity):
            return goal
        factor = self.number("factor")
        return BaseVelocity(goal.linear * factor, goal.angular * factor, goal.lateral * factor)


class Offset(GoalLayer):
    """`base.offset`: it turns as it drives, within its limits."""

    def find(self) -> str:
        """The base."""
        return base_of(self.description)

    def changed(self, goal: ActuatorGoal) -> ActuatorGoal:
        """The goal with the turn added; the driver refuses a goal that is not a speed."""
        if not isinstance(goal, BaseVelocity):
            return goal
        limit = max(self.description.base.angular, abs(goal.angular))
        angular = goal.angular + self.number("curvature") * goal.linear
        return BaseVelocity(goal.linear, max(-limit, min(limit, angular)), goal.lateral)

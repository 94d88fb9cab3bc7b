"""Faulty arms: they do not move as commanded, or are not where they report."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from momantu_bt.fault import Fault
from momantu_bt.faults.effects.robot.actuators import arm_of
from momantu_bt.faults.effects.robot.layer import GoalLayer, StuckLayer
from momantu_bt.geometry import Array
from momantu_bt.messages import (
    ActuatorGoal,
    JointPositions,
    JointTrajectory,
    RobotState,
    frozen,
)
from momantu_bt.robot import Robot


class Stuck(StuckLayer):
    """`arm.stuck`."""

    def find(self) -> str:
        """The arm."""
        return arm_of(self.description)


class Slow(GoalLayer):
    """`arm.slow`: trajectories are stretched in time.

    Positions without times are passed on unchanged: the driver chooses their speed.
    """

    def find(self) -> str:
        """The arm."""
        return arm_of(self.description)

    def changed(self, goal: ActuatorGoal) -> ActuatorGoal:
        """The stretched trajectory."""
        if not isinstance(goal, JointTrajectory):
            return goal
        factor = self.number("factor")
        return JointTrajectory(
            goal.names,
            np.asarray(frozen(np.asarray(goal.times) / factor)),
            goal.positions,
            np.asarray(frozen(np.asarray(goal.velocities) * factor)),
        )


class Offset(GoalLayer):
    """`arm.offset`: a joint reports `by` too much, and is sent `by` too low for it.

    So the robot sees no error, but the true arm is elsewhere. Raises KeyError if the arm has no
    such joint.
    """

    def __init__(self, inner: Robot, fault: Fault, seed: int) -> None:
        super().__init__(inner, fault, seed)
        self.joint = self._joint(str(fault.parameters["joint"]))
        self._inner: RobotState | None = None
        self._told: RobotState | None = None

    def find(self) -> str:
        """The arm."""
        return arm_of(self.description)

    def begin(self) -> None:
        """Forget the readings of this moment."""
        super().begin()
        self._inner = None

    def state(self) -> RobotState:
        """The state with the joint's false position."""
        now = self.inner.state()
        if not self.active:
            return now
        if self._told is None or self._inner is not now:
            positions = np.array(now.positions)
            positions[now.names.index(self.joint)] += self.number("by")
            self._inner, self._told = now, replace(now, positions=np.asarray(frozen(positions)))
        return self._told

    def changed(self, goal: ActuatorGoal) -> ActuatorGoal:
        """The goal that the joint really gets, within its limits."""
        if not isinstance(goal, JointTrajectory | JointPositions) or self.joint not in goal.names:
            return goal
        column = goal.names.index(self.joint)
        positions = np.array(goal.positions, dtype=np.float64)
        positions[..., column] = self._shifted(positions[..., column])
        if isinstance(goal, JointPositions):
            return JointPositions(goal.names, tuple(positions.tolist()))
        return replace(goal, positions=np.asarray(frozen(positions)))

    def _shifted(self, positions: Array) -> Array:
        limit = self.description.joint_limits[self.joint]
        low = -math.inf if limit.lower is None else limit.lower
        high = math.inf if limit.upper is None else limit.upper
        return np.clip(positions - self.number("by"), low, high)

    def _joint(self, wanted: str) -> str:
        joints = self.description.actuators[self.actuator].joints
        if wanted and wanted not in joints:
            raise KeyError(f"the arm has no joint {wanted!r}; it has: {', '.join(joints)}")
        if wanted:
            return wanted
        tree, effector = self.description.kinematics(), self.description.end_effector
        chain = tree.joints() if effector is None else tree.chain(effector.frame)
        turning = [j.name for j in chain if j.kind != "prismatic" and j.name in joints]
        if not turning:
            raise KeyError("the arm has no joint that turns")
        return turning[0]

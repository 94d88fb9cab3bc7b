"""A layer around a robot that passes everything on until its fault begins."""

from __future__ import annotations

from momantu_bt.fault import Fault
from momantu_bt.messages import ActuatorGoal, JointTrajectory, RobotState
from momantu_bt.robot import Robot, RobotDescription, SensorReading


class Layer:
    """Implements `Robot` and `Effect`. Subclasses change what passes while they are active.

    The constructor raises KeyError if the robot lacks something; the error says what.
    """

    def __init__(self, inner: Robot, fault: Fault, seed: int) -> None:
        self.inner = inner
        self.fault = fault
        self.seed = seed
        self.active = False

    def begin(self) -> None:
        """Change things from now on."""
        self.active = True

    def end(self) -> None:
        """Pass on everything again."""
        self.active = False

    def number(self, name: str) -> float:
        """A parameter of the fault."""
        return float(self.fault.parameters[name])

    @property
    def description(self) -> RobotDescription:
        """The robot's description."""
        return self.inner.description

    def state(self) -> RobotState:
        """The current joints and odometry."""
        return self.inner.state()

    def read(self, sensor: str) -> SensorReading:
        """The newest reading."""
        return self.inner.read(sensor)

    def command(self, actuator: str, goal: ActuatorGoal) -> None:
        """Give an actuator its goal."""
        self.inner.command(actuator, goal)

    def stop(self, actuator: str) -> None:
        """Brake."""
        self.inner.stop(actuator)


class GoalLayer(Layer):
    """A layer that changes the goals of one actuator.

    A trajectory keeps the form in which it was first given: the same object, commanded again,
    continues, but another object would have to start where the joints are.
    """

    def __init__(self, inner: Robot, fault: Fault, seed: int) -> None:
        super().__init__(inner, fault, seed)
        self.actuator = self.find()
        self._kept: tuple[ActuatorGoal, ActuatorGoal] | None = None

    def find(self) -> str:
        """Name of the actuator; KeyError when the robot has none."""
        raise NotImplementedError(f"{type(self).__name__} has no find()")

    def changed(self, goal: ActuatorGoal) -> ActuatorGoal:
        """The goal that the robot gets instead."""
        raise NotImplementedError(f"{type(self).__name__} has no changed()")

    def command(self, actuator: str, goal: ActuatorGoal) -> None:
        """Give the actuator the changed goal."""
        if actuator != self.actuator:
            self.inner.command(actuator, goal)
            return
        kept = self._kept
        if kept is None or kept[0] is not goal or not isinstance(goal, JointTrajectory):
            kept = (goal, self.changed(goal) if self.active else goal)
        self.inner.command(actuator, kept[1])
        self._kept = kept


class StuckLayer(Layer):
    """A layer that keeps one actuator from moving: it drops the commands."""

    def __init__(self, inner: Robot, fault: Fault, seed: int) -> None:
        super().__init__(inner, fault, seed)
        self.actuator = self.find()

    def find(self) -> str:
        """Name of the actuator; KeyError when the robot has none."""
        raise NotImplementedError(f"{type(self).__name__} has no find()")

    def begin(self) -> None:
        """Stop it."""
        super().begin()
        self.inner.stop(self.actuator)

    def command(self, actuator: str, goal: ActuatorGoal) -> None:
        """Pass the goal to the robot, unless it is for the stuck actuator."""
        if not self.active or actuator != self.actuator:
            self.inner.command(actuator, goal)

"""A robot without physics: joints move at their speed limits, the base integrates its velocity.

Tests script disturbances: `frozen` actuators do not move, `dead` sensors do not answer, and
`object_width` is the width of an object between the fingers.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose2D, wrap_angle
from momantu_bt.messages import (
    ActuatorGoal,
    BaseVelocity,
    GripperCommand,
    JointPositions,
    JointTrajectory,
    RobotState,
    frozen,
)
from momantu_bt.robot import WATCHDOG, ActuatorKind, RobotDescription, SensorReading
from momantu_bt.testing.description import small_robot

GRIPPER_SPEED = 0.1
"""m/s at which the scripted fingers move."""

Scripted: TypeAlias = "SensorReading | Callable[[ScriptedRobot], SensorReading]"


class ScriptedRobot:
    """Implements `Robot`. Call `advance(seconds)` to let time pass; `run_skill` does so.

    readings: by sensor name, the reading that `read` returns, or a function of this robot for it.
    """

    def __init__(
        self,
        description: RobotDescription | None = None,
        *,
        base: Pose2D | None = None,
        joints: Mapping[str, float] | None = None,
        gripper_width: float | None = None,
        readings: Mapping[str, Scripted] | None = None,
    ) -> None:
        self._description = description or small_robot()
        self.time = 0.0
        self.base = base or Pose2D(0.0, 0.0, 0.0)
        self.linear = self.angular = self.lateral = 0.0
        names = [n for a in self._description.actuators.values() for n in a.joints]
        self.joints = dict.fromkeys(names, 0.0) | dict(joints or {})
        self.speeds = dict.fromkeys(self.joints, 0.0)
        hand = self._description.end_effector
        full = 0.0 if hand is None else hand.max_width
        self.gripper_width = full if gripper_width is None else gripper_width
        self.gripper_effort = 0.0
        self.object_width: float | None = None
        """Width of the object between the fingers, m; None if there is none."""
        self.frozen: set[str] = set()
        """Names of actuators that ignore commands and do not move."""
        self.dead: set[str] = set()
        """Names of sensors that do not answer (SENSOR_DEAD)."""
        self.readings: dict[str, Scripted] = dict(readings or {})
        self.commands: list[tuple[float, str, ActuatorGoal | None]] = []
        """(time, actuator, goal) of all commands; the goal None is a `stop`."""
        self._goals: dict[str, _Goal] = {}

    @property
    def description(self) -> RobotDescription:
        """The robot's description."""
        return self._description

    def now(self) -> float:
        """Seconds since the robot was created; so the robot can serve as a clock."""
        return self.time

    def state(self) -> RobotState:
        """The current joints and odometry, without errors."""
        names = tuple(self.joints)
        return RobotState(
            stamp=self.time,
            names=names,
            positions=frozen(np.array([self.joints[n] for n in names])),
            velocities=frozen(np.array([self.speeds[n] for n in names])),
            efforts=frozen(np.zeros(len(names))),
            odom_from_base=self.base.transform(),
            linear=self.linear,
            angular=self.angular,
            gripper_width=self.gripper_width,
            gripper_effort=self.gripper_effort,
            lateral=self.lateral,
        )

    def read(self, sensor: str) -> SensorReading:
        """The scripted reading of the sensor.

        Raises:
            KeyError: the robot has no such sensor, or the test scripted nothing for it.
            Failure: SENSOR_DEAD for a sensor in `dead`.
        """
        if sensor not in self._description.sensors:
            names = ", ".join(self._description.sensors)
            raise KeyError(f"no sensor {sensor!r}; sensors: {names}")
        if sensor in self.dead:
            raise Failure("SENSOR_DEAD", f"{sensor} does not answer", sensor=sensor)
        if sensor not in self.readings:
            raise KeyError(f"this test scripted no reading of {sensor!r}: set readings[{sensor!r}]")
        scripted = self.readings[sensor]
        return scripted(self) if callable(scripted) else scripted

    def command(self, actuator: str, goal: ActuatorGoal) -> None:
        """Accept a goal; raises KeyError or ValueError as `Robot.command` does."""
        self._check(actuator, goal)
        before = self._goals.get(actuator)
        same = before is not None and before.goal is goal
        begun = before.begun if same and before is not None else self.time
        self._goals[actuator] = _Goal(goal, begun, self.time)
        self.commands.append((self.time, actuator, goal))

    def stop(self, actuator: str) -> None:
        """Drop the goal. A gripper keeps its goal, as real drivers keep the last force."""
        if actuator not in self._description.actuators:
            raise KeyError(f"no actuator {actuator!r}; {', '.join(self._description.actuators)}")
        self.commands.append((self.time, actuator, None))
        if self._description.actuators[actuator].kind is not ActuatorKind.GRIPPER:
            self._goals.pop(actuator, None)

    def advance(self, seconds: float) -> None:
        """Let time pass: move all actuators towards their goals."""
        self.time += seconds
        for joint in self.speeds:
            self.speeds[joint] = 0.0
        target = BaseVelocity(0.0, 0.0)
        for actuator, goal in list(self._goals.items()):
            gripper = self._description.actuators[actuator].kind is ActuatorKind.GRIPPER
            if not gripper and self.time - goal.renewed > WATCHDOG + 1e-9:
                del self._goals[actuator]
            elif actuator in self.frozen:
                continue
            elif isinstance(goal.goal, BaseVelocity):
                target = goal.goal
            else:
                self._move(goal, seconds)
        self._drive(target, seconds)

    def _move(self, goal: _Goal, seconds: float) -> None:
        wanted = goal.goal
        if isinstance(wanted, JointTrajectory):
            at = self.time - goal.begun
            for column, joint in enumerate(wanted.names):
                self._set_joint(joint, _interpolated(wanted, column, at), seconds)
        elif isinstance(wanted, JointPositions):
            for joint, position in zip(wanted.names, wanted.positions, strict=True):
                reach = self._description.joint_limits[joint].velocity * seconds
                gap = position - self.joints[joint]
                self._set_joint(joint, self.joints[joint] + _clamp(gap, reach), seconds)
        elif isinstance(wanted, GripperCommand):
            self._close(wanted, seconds)

    def _set_joint(self, joint: str, position: float, seconds: float) -> None:
        self.speeds[joint] = (position - self.joints[joint]) / seconds
        self.joints[joint] = position

    def _close(self, wanted: GripperCommand, seconds: float) -> None:
        full = self._description.hand.max_width
        floor = 0.0 if self.object_width is None else self.object_width
        target = min(full, max(wanted.width, floor))
        self.gripper_width += _clamp(target - self.gripper_width, GRIPPER_SPEED * seconds)
        squeezing = wanted.width < floor and self.gripper_width <= floor + 1e-9
        self.gripper_effort = wanted.max_force if squeezing else 0.0

    def _drive(self, target: BaseVelocity, seconds: float) -> None:
        limits = self._description.base
        self.linear += _clamp(
            _clamp(target.linear, limits.linear) - self.linear,
            limits.linear_acceleration * seconds,
        )
        self.angular += _clamp(
            _clamp(target.angular, limits.angular) - self.angular,
            limits.angular_acceleration * seconds,
        )
        self.lateral += _clamp(
            _clamp(target.lateral, limits.sideways) - self.lateral,
            limits.linear_acceleration * seconds,
        )
        middle = self.base.yaw + 0.5 * self.angular * seconds
        c, s = math.cos(middle), math.sin(middle)
        self.base = Pose2D(
            self.base.x + self.linear * c * seconds - self.lateral * s * seconds,
            self.base.y + self.linear * s * seconds + self.lateral * c * seconds,
            wrap_angle(self.base.yaw + self.angular * seconds),
        )

    def _check(self, actuator: str, goal: ActuatorGoal) -> None:
        actuators = self._description.actuators
        if actuator not in actuators:
            raise KeyError(f"no actuator {actuator!r}; actuators: {', '.join(actuators)}")
        takes = _TAKES[actuators[actuator].kind]
        if not isinstance(goal, takes):
            names = " or ".join(kind.__name__ for kind in takes)
            raise ValueError(f"{actuator} takes {names}, not {type(goal).__name__}")
        if isinstance(goal, JointTrajectory | JointPositions):
            foreign = [n for n in goal.names if n not in actuators[actuator].joints]
            if foreign:
                raise ValueError(f"{actuator} does not move {', '.join(foreign)}")
            self._check_limits(goal)

    def _check_limits(self, goal: JointTrajectory | JointPositions) -> None:
        for name, row in zip(goal.names, np.atleast_2d(np.asarray(goal.positions)).T, strict=True):
            limit = self._description.joint_limits[name]
            low = -math.inf if limit.lower is None else limit.lower
            high = math.inf if limit.upper is None else limit.upper
            if float(row.min()) < low - LIMIT_SLACK or float(row.max()) > high + LIMIT_SLACK:
                raise ValueError(
                    f"{name} is asked to {float(row.min()):.4f} … {float(row.max()):.4f}, "
                    f"its limits are {low} … {high}"
                )


LIMIT_SLACK = 1e-3
"""A goal may exceed a joint's limit by this, rad or m, as joint measurements have an error."""

_TAKES: dict[ActuatorKind, tuple[type[Any], ...]] = {
    ActuatorKind.BASE: (BaseVelocity,),
    ActuatorKind.JOINTS: (JointTrajectory, JointPositions),
    ActuatorKind.GRIPPER: (GripperCommand,),
}


class _Goal:
    __slots__ = ("begun", "goal", "renewed")

    def __init__(self, goal: ActuatorGoal, begun: float, renewed: float) -> None:
        self.goal, self.begun, self.renewed = goal, begun, renewed


def _clamp(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))


def _interpolated(trajectory: JointTrajectory, column: int, at: float) -> float:
    """Position at `at` seconds on the cubic Hermite spline through positions and velocities."""
    times = trajectory.times
    if at >= times[-1]:
        return float(trajectory.positions[-1, column])
    after = max(1, int(np.searchsorted(times, at, side="right")))
    span = float(times[after] - times[after - 1])
    s = (at - float(times[after - 1])) / span
    p0, p1 = (float(trajectory.positions[i, column]) for i in (after - 1, after))
    v0, v1 = (float(trajectory.velocities[i, column]) * span for i in (after - 1, after))
    return (
        p0 * (1 + 2 * s) * (1 - s) ** 2
        + v0 * s * (1 - s) ** 2
        + p1 * s * s * (3 - 2 * s)
        + v1 * s * s * (s - 1)
    )

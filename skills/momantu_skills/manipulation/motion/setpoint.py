"""A setpoint of joints that moves on tick by tick, for jogging: the driver follows it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.messages import JointPositions
from momantu_bt.robot import Robot, RobotDescription

ARRIVED = 0.02
"""Distance from the setpoint within which the joints have arrived, rad or m."""
BEHIND = 0.1
"""How much farther than a braking distance joints may lag behind the setpoint, rad or m."""


class Setpoint:
    """Joint positions that an actuator is sent to, a small step further at each tick.

    The driver follows within its acceleration limits. At a constant speed it lags behind by its
    braking distance, so it comes to rest at the setpoint as soon as that stands still.

    names, lower, upper, velocity: of the actuator's joints (n,); endless joints are unbounded.
    joints: the setpoint (n,), rad or m; None before the first step.
    """

    def __init__(self, robot: Robot, actuator: str) -> None:
        description = robot.description
        self._robot, self._actuator = robot, actuator
        self.names = description.actuators[actuator].joints
        self.lower, self.upper = limits_of(description, self.names)
        limits = [description.joint_limits[name] for name in self.names]
        self.velocity = np.array([limit.velocity for limit in limits])
        self._acceleration = np.array([limit.acceleration for limit in limits])
        self._fastest = np.zeros(len(self.names))
        self.joints: Array | None = None

    @property
    def measured(self) -> Array:
        """The joints (n,) as measured, within their limits."""
        state = self._robot.state()
        found = np.array([state.position(name) for name in self.names])
        return np.asarray(np.clip(found, self.lower, self.upper))

    def begin(self) -> Array:
        """The setpoint (n,), or where the joints are if there is none."""
        if self.joints is None:
            self.joints = self.measured
            self._fastest[:] = 0.0
        return self.joints

    def move(self, joints: Array, seconds: float) -> None:
        """Send the actuator to joints (n,), within `seconds` of the ones before."""
        change = np.abs(joints - self.begin()) / seconds
        self._fastest = np.maximum(self._fastest, change)
        self.joints = joints
        self.command()

    def command(self) -> None:
        """Send the actuator to the setpoint, if there is one."""
        if self.joints is not None:
            goal = JointPositions(self.names, tuple(float(q) for q in self.joints))
            self._robot.command(self._actuator, goal)

    def drop(self) -> None:
        """Brake at once, and forget the setpoint."""
        if self.joints is not None:
            self._robot.stop(self._actuator)
            self.joints = None

    def held_back(self) -> str | None:
        """The joint that does not follow, with the setpoint dropped; None if all do."""
        if self.joints is None:
            return None
        off = np.abs(self.joints - self.measured)
        if bool(np.all(off < ARRIVED)):
            self._fastest[:] = 0.0
        late = off - self._fastest**2 / (2.0 * self._acceleration) - BEHIND
        worst = int(np.argmax(late))
        if late[worst] <= 0.0:
            return None
        self.drop()
        return self.names[worst]

    def stepped(self, speeds: dict[str, float], seconds: float) -> tuple[Array, str | None]:
        """The setpoint after a step at these speeds by joint, and a joint that is at its limit."""
        start = self.begin()
        given = np.array([speeds.get(name, 0.0) for name in self.names])
        given = np.clip(given, -self.velocity, self.velocity)
        joints = np.clip(start + given * seconds, self.lower, self.upper)
        stuck = (given != 0.0) & (joints == start)
        return joints, self.names[int(np.argmax(stuck))] if stuck.any() else None


def limits_of(description: RobotDescription, names: Sequence[str]) -> tuple[Array, Array]:
    """Least and greatest positions (n,) of joints; infinite where a joint turns without end."""
    limits = [description.joint_limits[name] for name in names]
    lower = [-math.inf if limit.lower is None else limit.lower for limit in limits]
    upper = [math.inf if limit.upper is None else limit.upper for limit in limits]
    return np.array(lower), np.array(upper)

"""The robot as a recorded run has it: the same, and what is read of it is kept for the record."""

from __future__ import annotations

from momantu_bt.messages import ActuatorGoal, CameraImage, LaserScan, RobotState
from momantu_bt.robot import Robot, RobotDescription, SensorReading

EVERY = 1.0
"""Simulated seconds between two kept readings of one sensor."""
_SLACK = 1e-6


class Tap:
    """Wraps a `Robot` and keeps its readings. It reads no sensor by itself.

    taken: pictures and scans by sensor, at most one each EVERY seconds, until somebody empties it.
    """

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._due: dict[str, float] = {}
        self.taken: dict[str, CameraImage | LaserScan] = {}

    @property
    def description(self) -> RobotDescription:
        """The robot's description."""
        return self._robot.description

    def state(self) -> RobotState:
        """Joints and odometry of now."""
        return self._robot.state()

    def read(self, sensor: str) -> SensorReading:
        """The newest reading of a sensor; kept when it is due."""
        reading = self._robot.read(sensor)
        if reading.stamp >= self._due.get(sensor, reading.stamp) - _SLACK and isinstance(
            reading, CameraImage | LaserScan
        ):
            self._due[sensor] = reading.stamp + EVERY
            self.taken[sensor] = reading
        return reading

    def command(self, actuator: str, goal: ActuatorGoal) -> None:
        """Give an actuator its goal."""
        self._robot.command(actuator, goal)

    def stop(self, actuator: str) -> None:
        """Brake."""
        self._robot.stop(actuator)

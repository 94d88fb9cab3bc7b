"""The owners of actuators, and the robot as a skill sees it.

A skill owns an actuator from its first command until its generator ends, however it ends; then
the actuator is stopped. Every command and stop of a tick is kept for the run's fingerprint.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

from momantu_bt.engine.events import Events
from momantu_bt.engine.skills.sensor_check import SensorCheck
from momantu_bt.failure import ACTUATOR_BUSY, Failure
from momantu_bt.messages import ActuatorGoal, RobotState
from momantu_bt.robot import Robot, RobotDescription, SensorReading


@dataclass(frozen=True, slots=True)
class Issued:
    """One command to the robot: a goal for an actuator, or None to stop it."""

    actuator: str
    goal: ActuatorGoal | None


class SensorRead(NamedTuple):
    """A sensor was read; the reading has not been checked yet."""

    sensor: str
    reading: SensorReading


class Actuators:
    """Keeps track of which skill owns which actuator in a run."""

    def __init__(self, robot: Robot, events: Events | None = None) -> None:
        self.robot = robot
        self._events = events or Events()
        self.issued: list[Issued] = []
        """What was told to the robot since the list was last emptied."""
        self._owners: dict[str, Lease] = {}
        self._sensors = SensorCheck(robot.description)

    def lease(self, owner: str, uses: Iterable[str]) -> Lease:
        """The robot for a skill called `owner` that declares `uses`.

        Raises:
            KeyError: the robot lacks one of them; the message lists the actuators it has.
        """
        resolved = map(self.robot.description.resolve_use, sorted(uses))
        return Lease(self, owner, frozenset(name for name in resolved if name is not None))

    def owner(self, actuator: str) -> str | None:
        """Name of the node that owns an actuator, if any."""
        lease = self._owners.get(actuator)
        return None if lease is None else lease.owner

    def stop_all(self) -> None:
        """Stop every actuator of the robot, owned or not.

        All are stopped even if one raises; the first exception is raised at the end.
        """
        self._owners.clear()
        troubles: list[BaseException] = []
        for actuator in self.robot.description.actuators:
            try:
                self._stop(actuator)
            except (
                BaseException
            ) as trouble:  # a driver's code; a signal waits until all have stopped
                troubles.append(trouble)
        if troubles:
            raise troubles[0]

    def _read(self, sensor: str) -> SensorReading:
        reading = self.robot.read(sensor)
        self._events.publish(SensorRead(sensor, reading))
        self._sensors.check(sensor, reading, self.robot.state())
        return reading

    def _claim(self, actuator: str, lease: Lease) -> None:
        holder = self._owners.setdefault(actuator, lease)
        if holder is not lease:
            raise Failure(
                ACTUATOR_BUSY,
                f"{actuator} belongs to {holder.owner} until that ends",
                actuator=actuator,
                owner=holder.owner,
            )

    def _release(self, lease: Lease) -> None:
        mine = [name for name, holder in self._owners.items() if holder is lease]
        for actuator in mine:
            del self._owners[actuator]
            self._stop(actuator)

    def _stop(self, actuator: str) -> None:
        self.robot.stop(actuator)
        self.issued.append(Issued(actuator, None))


class Lease:
    """A `Robot` that lets its skill command the actuators it declares, unless another owns one."""

    def __init__(self, book: Actuators, owner: str, allowed: frozenset[str]) -> None:
        self.owner = owner
        self._book = book
        self._robot = book.robot
        self._allowed = allowed

    @property
    def description(self) -> RobotDescription:
        """The robot's description."""
        return self._robot.description

    def state(self) -> RobotState:
        """The current joints and odometry."""
        return self._robot.state()

    def read(self, sensor: str) -> SensorReading:
        """The newest reading of a sensor.

        Raises:
            Failure: SENSOR_DEAD, the sensor does not answer, or its readings are unreliable.
        """
        return self._book._read(sensor)

    def command(self, actuator: str, goal: ActuatorGoal) -> None:
        """Give an actuator its goal and own it from now on.

        Raises:
            Failure: ACTUATOR_BUSY, naming the owner.
            PermissionError: the skill does not declare the actuator in `uses`.
        """
        self._enter(actuator)
        self._robot.command(actuator, goal)
        self._book.issued.append(Issued(actuator, goal))

    def stop(self, actuator: str) -> None:
        """Brake an actuator; the skill owns it from now on."""
        self._enter(actuator)
        self._book._stop(actuator)

    def end(self) -> None:
        """Stop and release all owned actuators. Calling it twice is safe."""
        if self._book._owners:
            self._book._release(self)

    def _enter(self, actuator: str) -> None:
        if actuator in self._robot.description.actuators and actuator not in self._allowed:
            raise PermissionError(undeclared_actuator(self.owner, actuator, self._allowed))
        self._book._claim(actuator, self)


def undeclared_actuator(who: str, actuator: str, allowed: Iterable[str]) -> str:
    """What is wrong with a command to an actuator that `uses` does not declare, and what to do."""
    declared = ", ".join(sorted(allowed)) or "nothing"
    return (
        f"{who} commands {actuator!r} but its `uses` declares {declared}: "
        f"add {actuator!r} to `uses`, so that the checker can see it"
    )

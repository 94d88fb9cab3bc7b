"""Skills that skills call: their robot, and one call from its inputs to its outputs."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np

from momantu_bt.engine.skills.actuators import undeclared_actuator
from momantu_bt.engine.skills.errors import CalledFailure, declared, skill_error
from momantu_bt.engine.skills.start import Seeds, Setup, begun, instance, outputs_at_end
from momantu_bt.failure import Failure, FailureValue
from momantu_bt.formats.names import valid_names
from momantu_bt.marker import Marker
from momantu_bt.messages import ActuatorGoal, RobotState
from momantu_bt.robot import Robot, RobotDescription, SensorReading
from momantu_bt.skill import Compute, Host, Skill
from momantu_bt.tree.skill_calls import undeclared_uses, undeclared_uses_text
from momantu_bt.values.admit import admit
from momantu_bt.world import seeded


class SkillHost(Host):
    """The host of one running skill: it passes on what the skill says, and runs what it calls."""

    _calls = 0
    _calling: tuple[str, SkillHost] | None = None

    def __init__(self, setup: Setup, seeds: Seeds) -> None:
        self._setup, self._seeds = setup, seeds

    @property
    def watched(self) -> bool:
        """Whether somebody sees what the skill draws."""
        return self._setup.context.reporter.watched

    @property
    def prefix(self) -> str:
        """`dock/` while the skill calls dock: it is put before the phases."""
        if self._calling is None:
            return ""
        name, host = self._calling
        return f"{name}/{host.prefix}"

    def random(self) -> np.random.Generator:
        """The random numbers of this start."""
        return seeded(*self._seeds)

    def log(self, text: str) -> None:
        """Show a line to whoever watches the run."""
        self._setup.context.reporter.log(text)

    def draw(self, markers: Sequence[Marker]) -> None:
        """Show markers to whoever watches the run."""
        if self.watched:
            self._setup.context.reporter.draw(markers)

    def call(
        self, skill: str | type[Skill], inputs: Mapping[str, Any]
    ) -> Generator[str | Compute, Any, Mapping[str, Any]]:
        """Run another skill to its end; see `Skill.call`."""
        name, kind = self._declared(skill)
        self._calls += 1
        robot = CalledRobot(self._setup.robot, name, kind)
        setup = Setup(kind, robot, self._setup.context)
        host = SkillHost(setup, (*self._seeds, self._calls, name))
        self._calling = name, host
        try:
            called = instance(setup, _admitted(kind, inputs), host)
            yield from begun(called, robot)
            outputs = outputs_at_end(called, setup, {})
        except Failure as failure:
            robot.end()
            raise CalledFailure(_named(declared(kind, failure), name)) from None
        except Exception as error:
            robot.end()
            raise CalledFailure(_named(skill_error(kind, error), name)) from None
        finally:
            self._calling = None
        robot.end()
        return MappingProxyType(outputs)

    def _declared(self, skill: str | type[Skill]) -> tuple[str, type[Skill]]:
        """The name and the class of a skill that may be called.

        Raises:
            TypeError: the caller does not declare the call.
            PermissionError: the caller does not declare one of its actuators.
        """
        caller = self._setup.kind
        name = skill if isinstance(skill, str) else skill.__name__
        if skill not in caller.calls:
            raise TypeError(f"{caller.__name__} calls {name}; add it to `calls`")
        kind = self._setup.context.skills.get(skill) if isinstance(skill, str) else skill
        if kind is None:
            known = sorted(self._setup.context.skills)
            raise TypeError(f"no skill {name!r} to call; {valid_names(name, known, 'skills')}")
        missing = undeclared_uses(caller, kind, self._setup.robot.description)
        if missing:
            raise PermissionError(undeclared_uses_text(caller.__name__, name, missing))
        return name, kind


class CalledRobot:
    """The caller's robot for a called skill, which may command the actuators that it declares.

    The caller owns them; `end` only stops those that the called skill has commanded.
    """

    def __init__(self, robot: Robot, name: str, kind: type[Skill]) -> None:
        self._robot, self._name = robot, name
        resolved = map(robot.description.resolve_use, sorted(kind.uses))
        self._allowed = tuple(actuator for actuator in resolved if actuator is not None)
        self._commanded: dict[str, None] = {}

    @property
    def description(self) -> RobotDescription:
        """The robot's description."""
        return self._robot.description

    def state(self) -> RobotState:
        """The current joints and odometry."""
        return self._robot.state()

    def read(self, sensor: str) -> SensorReading:
        """The newest reading of a sensor; raises Failure SENSOR_DEAD."""
        return self._robot.read(sensor)

    def command(self, actuator: str, goal: ActuatorGoal) -> None:
        """Give an actuator its goal; raises as `Lease.command` does."""
        self._enter(actuator)
        self._robot.command(actuator, goal)

    def stop(self, actuator: str) -> None:
        """Brake an actuator."""
        self._enter(actuator)
        self._robot.stop(actuator)

    def end(self) -> None:
        """Stop what the called skill has commanded."""
        for actuator in self._commanded:
            self._robot.stop(actuator)
        self._commanded.clear()

    def _enter(self, actuator: str) -> None:
        if actuator in self.description.actuators and actuator not in self._allowed:
            raise PermissionError(undeclared_actuator(self._name, actuator, self._allowed))
        self._commanded[actuator] = None


def _admitted(kind: type[Skill], inputs: Mapping[str, Any]) -> dict[str, Any]:
    """The inputs as a tree would convert them; unknown ones unchanged.

    Raises:
        Failure: WRONG_TYPE.
    """
    ports = kind.ports
    return {n: admit(v, ports[n]) if n in ports else v for n, v in inputs.items()}


def _named(value: FailureValue, name: str) -> FailureValue:
    return replace(value, node=name, node_type=name)

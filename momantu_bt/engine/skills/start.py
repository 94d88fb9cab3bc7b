"""An instance of a skill at its start, and its outputs at its end."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeAlias

from momantu_bt.failure import INPUT_MISSING, SERVICE_MISSING, Failure
from momantu_bt.frames import FrameBuffer
from momantu_bt.robot import Robot
from momantu_bt.skill import MISSING, Clock, Host, Port, Run, Skill
from momantu_bt.values.admit import admit_output
from momantu_bt.world import Site

Seeds: TypeAlias = tuple[str | float, ...]
"""Seeds of the random numbers of one start, as `seeded` takes them."""


@dataclass(frozen=True, slots=True)
class SkillContext:
    """What a skill instance gets besides the robot.

    skills: those that it may call by name. reporter: passes on what it logs and draws.
    """

    clock: Clock
    frames: FrameBuffer
    site: Site
    services: Mapping[str, Any]
    skills: Mapping[str, type[Skill]] = field(default_factory=dict)
    reporter: Host = field(default_factory=Host)


class OwnedRobot(Robot, Protocol):
    """A skill's robot; `end` stops what the skill has commanded."""

    def end(self) -> None:
        """Stop the actuators. Calling it twice is safe."""
        ...


@dataclass(frozen=True, slots=True)
class Signature:
    """A skill's ports, sorted by what a start and an end do with them. inputs: their names."""

    inputs: frozenset[str]
    outputs: tuple[Port, ...]
    live_outputs: tuple[Port, ...]


def _signature(kind: type[Skill]) -> Signature:
    ports = kind.ports.values()
    outputs = tuple(port for port in ports if port.direction == "out")
    return Signature(
        frozenset(port.name for port in ports if port.direction == "in"),
        outputs,
        tuple(port for port in outputs if port.live),
    )


class Setup:
    """Everything that is the same at each start of a skill by one node or one caller."""

    __slots__ = ("context", "kind", "robot", "signature")

    def __init__(self, kind: type[Skill], robot: OwnedRobot, context: SkillContext) -> None:
        self.kind = kind
        self.robot = robot
        self.context = context
        self.signature = _signature(kind)


def instance(setup: Setup, inputs: Mapping[str, Any], host: Host) -> Skill:
    """A new instance with all that it needs. inputs: of the ports' types, and immutable.

    Raises:
        Failure: SERVICE_MISSING, INPUT_MISSING.
        TypeError: it has no such input.
    """
    kind, context = setup.kind, setup.context
    if kind.needs:
        _refuse_missing_services(kind, context.services)
    skill = kind()
    if inputs.keys() != setup.signature.inputs:
        _refuse_unknown(kind, inputs)
        _refuse_absent(kind, inputs)
    if inputs:
        skill.port_values.update(inputs)
    skill.services, skill.clock = context.services, context.clock
    skill.frames, skill.site, skill.host = context.frames, context.site, host
    return skill


def begun(skill: Skill, robot: Robot) -> Run:
    """The generator of its work.

    Raises:
        TypeError: `run` is not a generator.
    """
    generator = skill.run(robot)
    if not hasattr(generator, "send"):
        raise TypeError(
            f"{type(skill).__name__}.run returned {type(generator).__name__}, expected a "
            "generator: write at least one `yield` in it"
        )
    return generator


def outputs_at_end(skill: Skill, setup: Setup, known: Mapping[str, Any]) -> dict[str, Any]:
    """All its outputs, of the ports' types and immutable. known: those that were admitted before.

    Raises:
        Failure: WRONG_TYPE.
        TypeError: an output was not given.
    """
    found, values = {}, skill.port_values
    for port in setup.signature.outputs:
        value = values.get(port.name, MISSING)
        if value is MISSING:
            raise TypeError(f"{type(skill).__name__} ended without giving output {port.name!r}")
        found[port.name] = admitted(value, port, known)
    return found


def admitted(value: Any, port: Port, known: Mapping[str, Any]) -> Any:
    """An output's value; one that is known already is not looked at again.

    Raises:
        Failure: WRONG_TYPE.
    """
    return value if value is known.get(port.name, MISSING) else admit_output(value, port)


def _refuse_missing_services(kind: type[Skill], running: Mapping[str, Any]) -> None:
    missing = [name for name in kind.needs if name not in running]
    if missing:
        having = ", ".join(running) or "none"
        raise Failure(
            SERVICE_MISSING,
            f"{kind.__name__} needs {', '.join(missing)}; running services: {having}",
            services=missing,
        )


def _refuse_unknown(kind: type[Skill], inputs: Mapping[str, Any]) -> None:
    valid = [p.name for p in kind.ports.values() if p.direction == "in"]
    unknown = [name for name in inputs if name not in valid]
    if unknown:
        names = ", ".join(valid) or "none"
        raise TypeError(f"{kind.__name__} has no input {', '.join(unknown)}; inputs: {names}")


def _refuse_absent(kind: type[Skill], inputs: Mapping[str, Any]) -> None:
    absent = [p.name for p in kind.ports.values() if p.required and p.name not in inputs]
    if absent:
        raise Failure(
            INPUT_MISSING, f"{kind.__name__} was started without {', '.join(absent)}", ports=absent
        )

"""An instance of a skill at its start, and its outputs at its end."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from momantu_bt.failure import INPUT_MISSING, SERVICE_MISSING, Failure
from momantu_bt.frames import FrameBuffer
from momantu_bt.robot import Robot
from momantu_bt.skill import MISSING, Clock, Host, Port, Run, Skill
from momantu_bt.values.admit import admit_output
from momantu_bt.world import Site, seeded


@dataclass(frozen=True, slots=True)
class SkillContext:
    """What a skill instance gets besides the robot.

    seeds: of its random numbers, as `seeded` takes them. skills: those that it may call by name.
    reporter: passes on what it logs and draws.
    """

    clock: Clock
    seeds: tuple[str | float, ...]
    frames: FrameBuffer
    site: Site
    services: Mapping[str, Any]
    skills: Mapping[str, type[Skill]] = field(default_factory=dict)
    reporter: Host = field(default_factory=Host)


def instance(
    kind: type[Skill], inputs: Mapping[str, Any], context: SkillContext, host: Host
) -> Skill:
    """A new instance with all that it needs. inputs: of the ports' types, and immutable.

    Raises:
        Failure: SERVICE_MISSING, INPUT_MISSING.
        TypeError: it has no such input.
    """
    missing = [name for name in kind.needs if name not in context.services]
    if missing:
        having = ", ".join(context.services) or "none"
        raise Failure(
            SERVICE_MISSING,
            f"{kind.__name__} needs {', '.join(missing)}; running services: {having}",
            services=missing,
        )
    skill = kind()
    _refuse_unknown(kind, inputs)
    skill.port_values.update(inputs)
    absent = [p.name for p in kind.ports.values() if p.required and p.name not in inputs]
    if absent:
        raise Failure(
            INPUT_MISSING,
            f"{kind.__name__} was started without {', '.join(absent)}",
            ports=absent,
        )
    skill.services, skill.clock = context.services, context.clock
    skill.random = seeded(*context.seeds)
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


def outputs_at_end(skill: Skill, known: Mapping[str, Any]) -> dict[str, Any]:
    """All its outputs, of the ports' types and immutable. known: those that were admitted before.

    Raises:
        Failure: WRONG_TYPE.
        TypeError: an output was not given.
    """
    found = {}
    for port in type(skill).ports.values():
        if port.direction != "out":
            continue
        value = skill.port_values.get(port.name, MISSING)
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


def _refuse_unknown(kind: type[Skill], inputs: Mapping[str, Any]) -> None:
    ports = kind.ports
    unknown = [n for n in inputs if n not in ports or ports[n].direction != "in"]
    if unknown:
        valid = ", ".join(p.name for p in ports.values() if p.direction == "in") or "none"
        raise TypeError(f"{kind.__name__} has no input {', '.join(unknown)}; inputs: {valid}")

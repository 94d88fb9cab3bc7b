"""What a robot lacks for a skill: actuators, and sensors of its own or of its services."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from momantu_bt.robot import RobotDescription
from momantu_bt.service import Service
from momantu_bt.skill import Skill


def lacking(
    kind: type[Skill], services: Mapping[str, type[Service]], description: RobotDescription
) -> Iterator[str]:
    """What a robot lacks to run a skill, such as "the actuator 'arm'" or "a camera".

    services: the installed ones; unknown ones are left out.

    Raises:
        PluginError: one of the services is broken.
    """
    for use in sorted(kind.uses):
        try:
            description.resolve_use(use)
        except KeyError:
            yield f"the actuator {use!r}"
    having = {sensor.kind for sensor in description.sensors.values()}
    senses = {*kind.senses, *_of_services(kind.needs, services)}
    yield from (f"a {sense}" for sense in sorted(senses - having))


def lacks_text(name: str, lacks: Iterable[str], description: RobotDescription) -> str:
    """A sentence about what a skill of this name lacks on a robot."""
    having = f"actuators: {', '.join(description.actuators) or 'none'}"
    sensors = f"sensors: {', '.join(description.sensors) or 'none'}"
    needed = " and ".join(lacks)
    return f"{name} needs {needed}, and the robot {description.name} has none; {having}; {sensors}"


def _of_services(names: Iterable[str], services: Mapping[str, type[Service]]) -> Iterator[str]:
    """Kinds of sensors that services, and those that they need, cannot do without."""
    waiting, seen = list(names), set[str]()
    while waiting:
        name = waiting.pop()
        if name not in seen and name in services:
            seen.add(name)
            yield from services[name].senses
            waiting += services[name].needs

"""What the skills share through which a person drives the robot: the person's command now."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from momantu_bt.failure import Failure
from momantu_bt.skill import Skill
from momantu_bt.teleoperation import OPERATOR, Command, operated_by

OPERATED: Mapping[str, str] = MappingProxyType(
    {"NO_OPERATOR": "nobody is at the controls: `momantu-bt teleop` lets a person drive"}
)
"""What these skills fail with."""


def commanded(skill: Skill) -> Command:
    """What the person wants now.

    Raises:
        Failure: NO_OPERATOR.
    """
    command: Command | None = skill.services[OPERATOR].command
    if command is None:
        raise Failure("NO_OPERATOR", "nobody is at the controls; run `momantu-bt teleop`")
    return command.at(skill.clock.now())


@dataclass(frozen=True, slots=True)
class Script:
    """A source of commands for tests: `wanted(now)` is the command; after `seconds` the end."""

    wanted: Callable[[float], Command]
    seconds: float

    def command(self, now: float) -> Command:
        """The scripted command."""
        return self.wanted(now) if now < self.seconds else Command(now, ended=True)


def rehearsed(wanted: Callable[[float], Command], seconds: float = 1.0) -> Mapping[str, Any]:
    """The service with a script, as `services` of a rehearsal."""
    return {OPERATOR: operated_by(Script(wanted, seconds))()}

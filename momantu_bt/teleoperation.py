"""Driving a robot by hand: what a person commands now, and the service that tells skills of it.

A source of commands, such as a keyboard, is asked at each tick of the world's clock. A command
lives only for a moment: where the person lets go, or the source falls silent, the robot stands.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar, Protocol, TypeAlias

from momantu_bt.robot import Robot
from momantu_bt.service import Service, ServiceContext

OPERATOR = "operator"
"""Name of the service that skills need to be driven by hand."""
DEAD_MAN = 0.5
"""Time of the world's clock after which a command that nobody renews has no effect, s."""
_SLACK = 1e-6
"""Rounding of the clock, s."""

Twist: TypeAlias = tuple[float, float, float, float, float, float]
"""Speed along x, y, z in m/s, and turning about x, y, z in rad/s."""
STANDING: Twist = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Command:
    """What a person wants the robot to do now.

    stamp: time of the world's clock when it was given, s. linear, angular: of the base, m/s along
    x and rad/s about z. hand: of the grasp frame about its origin, along the axes of the base
    frame. joints: speeds by joint, rad/s or m/s. opening: where the fingers are to go, m; None:
    they stay. stop: brake everything at once. ended: the person has left; skills brake and succeed.
    lateral: of an omnidirectional base along y, m/s.
    """

    stamp: float
    linear: float = 0.0
    angular: float = 0.0
    hand: Twist = STANDING
    joints: Mapping[str, float] = field(default_factory=dict)
    opening: float | None = None
    stop: bool = False
    ended: bool = False
    lateral: float = 0.0

    def at(self, now: float) -> Command:
        """The command as it counts at a time, s: one that is too old moves nothing."""
        if now - self.stamp <= DEAD_MAN + _SLACK:
            return self
        return Command(self.stamp, ended=self.ended)


class Source(Protocol):
    """What a person drives with: a keyboard, a gamepad, or a script in a test."""

    def command(self, now: float) -> Command:
        """What the person wants at a time of the world's clock, s. It must return at once."""
        ...


class Operator(Protocol):
    """The service of the name OPERATOR, as skills see it."""

    @property
    def command(self) -> Command | None:
        """The newest command; None if nobody is at the controls."""
        ...


class OperatorService(Service):
    """Asks a source for the person's command at each tick. As installed, nobody is at the controls.

    source: see `operated_by`. command: the newest one; None before the first.
    """

    rate: ClassVar[float] = 20.0
    source: ClassVar[Source | None] = None
    command: Command | None = None

    def start(self, context: ServiceContext) -> None:
        """Begin without a command."""
        self.command = None

    def update(self, robot: Robot, now: float) -> None:
        """Ask the source."""
        if self.source is not None:
            self.command = self.source.command(now)


def operated_by(source: Source) -> type[OperatorService]:
    """The service, with a person at the controls."""
    return type("OperatedService", (OperatorService,), {"__doc__": "Driven.", "source": source})

"""The context that all nodes of a run share: time, journals, robot, events."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple, TypeVar

from momantu_bt.engine.blackboard import Journal
from momantu_bt.engine.changes import Change
from momantu_bt.engine.events import Events
from momantu_bt.engine.outside import Answered, Logged, Outside, Refused
from momantu_bt.engine.person import Person, Scripted
from momantu_bt.engine.skills.body import Body
from momantu_bt.engine.watchdog import Watchdog
from momantu_bt.failure import Failure
from momantu_bt.skill import Clock

T = TypeVar("T")


class Remarked(NamedTuple):
    """A message for a person; it never influences the run."""

    text: str


@dataclass(slots=True)
class RunContext:
    """Shared by the nodes of one run.

    now: time of the world's clock at this tick, s. tick: its number, from 1.
    writes: cells written in this tick, with their values before. changes: of statuses in this tick.
    logs: what skills have logged in this tick.
    earlier: how many trees a session has run before this one; skills draw other numbers in each.
    person: answers questions.
    outside: source of everything that the tree gets from outside. watchdog: ends steps that hang.
    events: the stream of events, for observers.
    """

    clock: Clock
    seed: int = 0
    body: Body | None = None
    now: float = 0.0
    tick: int = 0
    writes: Journal = field(default_factory=list)
    changes: list[Change] = field(default_factory=list)
    logs: list[Logged] = field(default_factory=list)
    earlier: int = 0
    person: Person = field(default_factory=Scripted)
    outside: Outside = field(default_factory=Outside)
    events: Events = field(default_factory=Events)
    watchdog: Watchdog = field(default_factory=Watchdog)

    def begin_tick(self) -> None:
        """Read the clock and empty the journals."""
        self.now = self.clock.now()
        self.tick += 1
        self.writes.clear()
        self.changes.clear()
        self.logs.clear()

    def remark(self, text: str) -> None:
        """Publish a remark for a person."""
        self.events.publish(Remarked(text))

    def ask(self, key: str, ask: Callable[[], T]) -> T:
        """Call `ask` through `outside`, which may record or replay it. key: the question's name.

        Raises:
            Failure: there is no answer.
        """
        try:
            answer = self.outside.ask(key, ask)
        except Failure as failure:
            self.events.publish(Answered(key, Refused(failure.value)))
            raise
        self.events.publish(Answered(key, answer))
        return answer

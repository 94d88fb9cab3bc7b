"""What every node of a run shares: the clock's reading, the journals, the robot."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple, TypeVar

from momantu_bt.engine.blackboard import Journal
from momantu_bt.engine.changes import Change
from momantu_bt.engine.events import Events
from momantu_bt.engine.outside import Answered, Outside, Refused
from momantu_bt.engine.person import Person, Scripted
from momantu_bt.engine.skills.body import Body
from momantu_bt.engine.watchdog import Watchdog
from momantu_bt.failure import Failure
from momantu_bt.skill import Clock

T = TypeVar("T")


class Remarked(NamedTuple):
    """Something that a person should read, and that never influences the run."""

    text: str


@dataclass(slots=True)
class RunContext:
    """Shared by the nodes of one run.

    now: seconds of the world's clock at this tick. tick: its number, from 1.
    writes: cells written in this tick, with what they held before. changes: of statuses.
    person: answers questions.
    waited: seconds of wall time that the run has spent waiting for a person.
    outside: whatever comes from beyond the tree comes through it. watchdog: ends what hangs.
    events: what happens, for those who watch.
    """

    clock: Clock
    seed: int = 0
    body: Body | None = None
    now: float = 0.0
    tick: int = 0
    writes: Journal = field(default_factory=list)
    changes: list[Change] = field(default_factory=list)
    person: Person = field(default_factory=Scripted)
    waited: float = 0.0
    outside: Outside = field(default_factory=Outside)
    events: Events = field(default_factory=Events)
    watchdog: Watchdog = field(default_factory=Watchdog)

    def begin_tick(self) -> None:
        """Take the clock's reading and start empty journals."""
        self.now = self.clock.now()
        self.tick += 1
        self.writes.clear()
        self.changes.clear()

    def remark(self, text: str) -> None:
        """Publish a remark for a reader."""
        self.events.publish(Remarked(text))

    def ask(self, key: str, ask: Callable[[], T]) -> T:
        """The answer of `ask`, through the outside. key: the name of the question.

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

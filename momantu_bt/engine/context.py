"""What every node of a run shares: the clock's reading, the journals, the robot."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from momantu_bt.engine.blackboard import Journal
from momantu_bt.engine.body import Body
from momantu_bt.engine.changes import Change
from momantu_bt.engine.outside import Outside, SkillNode, SkillSession
from momantu_bt.engine.person import Person, Scripted
from momantu_bt.engine.watchdog import Watchdog
from momantu_bt.skill import Clock


@dataclass(slots=True)
class RunContext:
    """Shared by the nodes of one run.

    now: seconds of the world's clock at this tick. tick: its number, from 1.
    writes: cells written in this tick, with what they held before. changes: of statuses.
    remark: tells a person something that never influences the run. person: answers questions.
    waited: seconds of wall time that the run has spent waiting for a person.
    outside: whatever comes from beyond the tree comes through it. watchdog: ends what hangs.
    skill_ended: told of each skill that ended, at that instant; it changes nothing.
    """

    clock: Clock
    seed: int = 0
    body: Body | None = None
    now: float = 0.0
    tick: int = 0
    writes: Journal = field(default_factory=list)
    changes: list[Change] = field(default_factory=list)
    remark: Callable[[str], None] = print
    person: Person = field(default_factory=Scripted)
    waited: float = 0.0
    outside: Outside = field(default_factory=Outside)
    skill_ended: Callable[[SkillNode, SkillSession], None] | None = None
    watchdog: Watchdog = field(default_factory=Watchdog)

    def begin_tick(self) -> None:
        """Take the clock's reading and start empty journals."""
        self.now = self.clock.now()
        self.tick += 1
        self.writes.clear()
        self.changes.clear()

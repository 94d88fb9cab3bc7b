"""Begin and end the faults of one run, between its ticks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import inf

from momantu_bt.engine.context import RunContext
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.skills.session import CLOCK_SLACK
from momantu_bt.fault import Effect, Fault, FaultError
from momantu_bt.fault_kind import FOR
from momantu_bt.faults.effects.skills.victim import SkillFault
from momantu_bt.faults.spec import format_fault
from momantu_bt.faults.watch import PhaseWatch
from momantu_bt.record.report import FaultReport

NEVER = ""


@dataclass(slots=True)
class Staged:
    """One fault of a run: when it begins, and what then happens.

    effect: None for a fault that is there from the start (a site with wrong information).
    began, ended: s; None until then.
    """

    fault: Fault
    watch: PhaseWatch
    effect: Effect | None
    began: float | None = None
    ended: float | None = None
    waiting: str = NEVER

    @property
    def lasts(self) -> float:
        """Seconds from its beginning to its end."""
        return float(self.fault.parameters.get(FOR, inf))


class Director:
    """Acts after each tick, between the observers and the next step of the world."""

    def __init__(
        self, staged: Iterable[Staged], nodes: Sequence[TreeNode], remark: Callable[[str], None]
    ) -> None:
        self._staged = tuple(staged)
        self._nodes = nodes
        self._remark = remark

    def act(self, context: RunContext, settling: bool = False) -> None:
        """Begin the faults that are due, and end those that have lasted long enough.

        settling: the tree has ended, so no more faults begin.
        """
        for staged in self._staged:
            if staged.began is None:
                if not settling and staged.watch.begun(context):
                    self._begin(staged, context.now)
            elif staged.ended is None and context.now >= staged.began + staged.lasts - CLOCK_SLACK:
                if staged.effect is not None:
                    staged.effect.end()
                staged.ended = context.now

    def reports(self) -> tuple[FaultReport, ...]:
        """The progress of each fault so far, in their given order."""
        return tuple(FaultReport(format_fault(s.fault), s.began, s.ended) for s in self._staged)

    def _begin(self, staged: Staged, now: float) -> None:
        """Begin it, or say once why it cannot happen at this instant and try again a tick later."""
        effect = staged.effect
        try:
            if isinstance(effect, SkillFault):
                effect.aim(staged.watch.node, self._nodes)
            if effect is not None:
                effect.begin()
        except FaultError as error:
            if staged.waiting != str(error):
                staged.waiting = str(error)
                self._remark(f"{staged.fault.name} at {now:.2f} s: {error}; it is tried again")
            return
        staged.began = now

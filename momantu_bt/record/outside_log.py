"""The log of what reached a tree from outside in a tick, in its order, for the record."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from momantu_bt.engine.events import Events
from momantu_bt.engine.outside import Answered, SkillNode, SkillSession, SkillStepped
from momantu_bt.engine.status import Status
from momantu_bt.failure import FailureValue


class Step(NamedTuple):
    """One step of one skill. outputs: by port, the values that changed since its last step."""

    leaf: SkillNode
    status: Status
    phase: str
    failure: FailureValue | None
    outputs: Mapping[str, Any]


class OutsideLog:
    """Keeps steps of skills and answers to questions until `clear`.

    reads: each answer with its key; `Refused` stands for a failure.
    """

    def __init__(self, events: Events) -> None:
        self.steps: list[Step] = []
        self.reads: list[Answered] = []
        self._given: dict[SkillNode, tuple[SkillSession, dict[str, Any]]] = {}
        events.subscribe(SkillStepped, self._stepped)
        events.subscribe(Answered, self.reads.append)

    def clear(self) -> None:
        """Forget the steps and answers, as a new tick begins."""
        self.steps.clear()
        self.reads.clear()

    def _stepped(self, event: SkillStepped) -> None:
        leaf, session, status = event
        of, given = self._given.get(leaf, (None, {}))
        if of is not session:  # a new start: all that it writes is new
            given = {}
            self._given[leaf] = session, given
        outputs = session.outputs
        new = {n: v for n, v in outputs.items() if n not in given or given[n] is not v}
        given.update(new)
        self.steps.append(Step(leaf, status, session.phase, session.failure, new))

"""Gather when each leaf of the tree ran."""

from __future__ import annotations

from dataclasses import dataclass, field

from momantu_bt.failure import FailureValue
from momantu_bt.page.statuses import FAILURE, IDLE, RUNNING, SKIPPED
from momantu_bt.record.recording import ChangeRecord, Recording, TickRecord


@dataclass(slots=True)
class Bar:
    """A stretch in which a leaf was running, or the tick in which it began and ended.

    begin, end: indices of ticks. label: the node in one line, with the values it started with.
    notes: its notes of progress, in order.
    """

    node: int
    begin: int
    end: int
    label: str
    status: str = RUNNING
    notes: list[str] = field(default_factory=list)
    failure: FailureValue | None = None


def bars(recording: Recording) -> list[Bar]:
    """All of them, by their beginnings."""
    finder = _Finder(recording)
    for index, tick in enumerate(recording.ticks):
        finder.tick(index, tick)
    return finder.found


class _Finder:
    def __init__(self, recording: Recording) -> None:
        self._inner = {node.parent for node in recording.nodes}
        self._labels = [node.label for node in recording.nodes]
        self._last = len(recording.ticks) - 1
        self._running: dict[int, Bar] = {}
        self.found: list[Bar] = []

    def tick(self, index: int, tick: TickRecord) -> None:
        """Go on by one tick."""
        for node, label in tick.labels:
            self._labels[node] = label
        for change in tick.changes:
            if change.node not in self._inner:
                self._changed(index, change)
        for node, note in tick.notes:
            if node in self._running:
                self._running[node].notes.append(note)

    def _changed(self, index: int, change: ChangeRecord) -> None:
        stopped = change.status in (IDLE, SKIPPED)
        bar = self._running.pop(change.node, None)
        if bar is None:
            if stopped:
                return
            bar = Bar(change.node, index, index, self._labels[change.node])
            self.found.append(bar)
        bar.status = IDLE if stopped else change.status
        bar.end = index
        if change.status == RUNNING:
            self._running[change.node] = bar
            bar.end = self._last
            bar.notes += [change.note] if change.note else []
        elif change.status == FAILURE:
            bar.failure = change.failure

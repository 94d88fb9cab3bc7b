"""The status of each node as changes, tick by tick, and the numbers of statuses.

`record.js` has the same numbers.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from momantu_bt.engine.status import Status
from momantu_bt.record.recording import Recording
from momantu_bt.replay.statuses import Statuses

IDLE, RUNNING, SUCCESS, FAILURE, SKIPPED = (status.value for status in Status)
STATUS_NUMBERS = {status.value: number for number, status in enumerate(Status)}
"""Statuses as a record writes them, and their numbers in the page's data."""


@dataclass(frozen=True, slots=True)
class Shown:
    """From the tick of this index on, a node shows this status and note."""

    tick: int
    node: int
    status: str
    note: str


def shown(recording: Recording) -> Iterator[Shown]:
    """Every change of what is shown, in the order of ticks and nodes."""
    statuses = Statuses(recording.nodes)
    before = [(IDLE, "")] * len(recording.nodes)
    notes = [""] * len(recording.nodes)
    for index, tick in enumerate(recording.ticks):
        if not tick.changes and not tick.notes:
            continue
        statuses.tick(tick.changes)
        for node, note in (*((c.node, c.note) for c in tick.changes), *tick.notes):
            notes[node] = note
        now = [(s.value, note) for s, note in zip(statuses.shown(), notes, strict=True)]
        for node, (old, new) in enumerate(zip(before, now, strict=True)):
            if old != new:
                yield Shown(index, node, *new)
        before = now

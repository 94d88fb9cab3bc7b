"""A record as a sequence of moments, with quick access to each."""

from __future__ import annotations

import math
from bisect import bisect_right
from functools import lru_cache

from momantu_bt.record.recording import Recording, TickRecord
from momantu_bt.replay.moment import Moment, ShownNode
from momantu_bt.replay.seek import SeekError
from momantu_bt.replay.statuses import Statuses
from momantu_bt.skill import MISSING

EVERY = 64
"""The ticks between two stored states. To find a moment takes at most so many ticks' work."""
_SLACK = 1e-9


class Timeline:
    """The moments of a record: `len`, and `moment` of an index."""

    def __init__(self, recording: Recording) -> None:
        self.recording = recording
        self.times = [tick.now for tick in recording.ticks]
        self._kept: list[_State] = []
        state = _State.before(recording)
        for index, tick in enumerate(recording.ticks):
            if index % EVERY == 0:
                self._kept.append(state.copy())
            state.apply(tick)
        self._built = lru_cache(maxsize=8)(self._build)

    def __len__(self) -> int:
        """The number of moments."""
        return len(self.recording.ticks)

    def moment(self, index: int) -> Moment:
        """The moment after a tick, by its position in the record."""
        return self._built(range(len(self))[index])

    def at(self, time: float) -> int:
        """The index of the last tick at or before a time, s; the first tick's if all are later.

        Raises:
            SeekError: the time is not a number.
        """
        if math.isnan(time):
            raise SeekError("nan is not a time; write seconds, such as 42.5")
        return max(0, bisect_right(self.times, time + _SLACK) - 1)

    def _build(self, index: int) -> Moment:
        start = index - index % EVERY
        state = self._kept[index // EVERY].copy()
        for tick in self.recording.ticks[start : index + 1]:
            state.apply(tick)
        return state.moment(index, self.recording)


class _State:
    """The state after some tick."""

    def __init__(self, statuses: Statuses, labels: list[str], notes: dict[int, str]) -> None:
        self.statuses = statuses
        self.labels = labels
        self.notes = notes
        self.board: dict[str, object] = {}

    @classmethod
    def before(cls, recording: Recording) -> _State:
        """Before the first tick."""
        return cls(Statuses(recording.nodes), [node.label for node in recording.nodes], {})

    def copy(self) -> _State:
        """A copy that can be changed on its own."""
        twin = _State(self.statuses.copy(), list(self.labels), dict(self.notes))
        twin.board = dict(self.board)
        return twin

    def apply(self, tick: TickRecord) -> None:
        """Apply one tick."""
        self.statuses.tick(tick.changes)
        self.notes |= {change.node: change.note for change in tick.changes}
        self.notes.update(tick.notes)
        for node, label in tick.labels:
            self.labels[node] = label
        for cell, value in tick.writes:
            self.board.pop(cell, None)
            if value is not MISSING:
                self.board[cell] = value

    def moment(self, index: int, recording: Recording) -> Moment:
        """The state as a value that later ticks do not change."""
        nodes: list[ShownNode] = []
        below: dict[int, list[ShownNode]] = {}
        for info, status in zip(recording.nodes, self.statuses.shown(), strict=True):
            above = None if info.parent is None else nodes[info.parent]
            node = ShownNode(
                info,
                self.labels[info.index],
                self.notes.get(info.index, ""),
                status,
                self.statuses.failures[info.index],
                above,
            )
            nodes.append(node)
            if info.parent is not None:
                below.setdefault(info.parent, []).append(node)
        for parent, kids in below.items():
            nodes[parent].kids = tuple(kids)
        board = {cell: self.board[cell] for cell in sorted(self.board)}
        return Moment(index, recording.ticks[index], tuple(nodes), board)

"""Whether a record that was read hangs together: a damaged file may still be JSON."""

from __future__ import annotations

from collections.abc import Iterator

from momantu_bt.engine.status import Status
from momantu_bt.record.recording import Recording, TickRecord

_STATUSES = frozenset(status.value for status in Status)


def check_sound(recording: Recording) -> None:
    """Look at what readers follow: the tree's shape, numbers of nodes, names of statuses.

    Raises:
        ValueError: something leads nowhere; the message says what.
    """
    nodes = recording.nodes
    for place, node in enumerate(nodes):
        if node.index != place or (node.parent is None) != (place == 0):
            raise ValueError(f"node {place} does not stand where it says")
        if node.parent is not None and not 0 <= node.parent < place:
            raise ValueError(f"node {place} is below node {node.parent}")
    known = range(len(nodes))
    for tick in recording.ticks:
        for named in _nodes_in(tick):
            if named not in known:
                raise ValueError(f"tick {tick.number} names node {named} of {len(nodes)}")
        for status in _statuses_in(tick):
            if status not in _STATUSES:
                raise ValueError(f"tick {tick.number} has the status {status!r}")


def _nodes_in(tick: TickRecord) -> Iterator[int]:
    yield from (change.node for change in tick.changes)
    yield from (step.node for step in tick.steps)
    yield from (node for node, _ in tick.notes)
    yield from (node for node, _ in tick.labels)


def _statuses_in(tick: TickRecord) -> Iterator[str]:
    yield from (change.status for change in tick.changes)
    yield from (step.status for step in tick.steps)

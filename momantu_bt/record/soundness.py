"""Check that a record is consistent: a damaged file may still be valid JSON."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from momantu_bt.engine.status import Status
from momantu_bt.record.recording import Recording, TickRecord

_STATUSES = frozenset(status.value for status in Status)
_ABOUT = ("tree", "world", "robot", "seed", "options", "values", "versions")
_REPORT = (
    *("status", "success", "failure", "unmet", "measures", "sim_time_s", "wall_time_s", "ticks"),
    *("nodes", "fingerprint", "error"),
)
_FAILURE = ("code", "message")
_NODE = ("name", "type", "place", "ticks", "runs", "failures", "seconds")


def check_sound(recording: Recording) -> None:
    """Check what readers rely on: the tree's shape, numbers of nodes, names of statuses, fields.

    Raises:
        ValueError: a reference is wrong or something is missing; the message says what.
    """
    _check_fields("the run", recording.about, _ABOUT)
    if recording.report is not None:
        _check_fields("the report", recording.report, _REPORT)
        if recording.report["failure"] is not None:
            _check_fields("the report's failure", recording.report["failure"], _FAILURE)
        for place, counts in enumerate(recording.report["nodes"]):
            _check_fields(f"node {place} of the report", counts, _NODE)
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


def _check_fields(what: str, data: Any, names: Iterable[str]) -> None:
    missing = [name for name in names if not isinstance(data, Mapping) or name not in data]
    if missing:
        raise ValueError(f"{what} lacks {', '.join(missing)}")


def _nodes_in(tick: TickRecord) -> Iterator[int]:
    yield from (change.node for change in tick.changes)
    yield from (step.node for step in tick.steps)
    yield from (node for node, _ in tick.notes)
    yield from (node for node, _ in tick.labels)
    yield from (node for node, _ in tick.logs)


def _statuses_in(tick: TickRecord) -> Iterator[str]:
    yield from (change.status for change in tick.changes)
    yield from (step.status for step in tick.steps)

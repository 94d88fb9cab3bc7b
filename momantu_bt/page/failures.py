"""Gather the failures of a run, each with the chain that led to it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePath
from typing import Any

from momantu_bt.failure import FailureValue
from momantu_bt.page.statuses import FAILURE
from momantu_bt.page.tables import value_text
from momantu_bt.record.recording import NodeInfo, Recording, TickRecord
from momantu_bt.record.text.failure import tries_text
from momantu_bt.replay.run_text import report_of

_MOST_LINKS = 200
"""Longest chain; a longer one is cut."""
_CAUSE, _BESIDE = "because of ", "after "


def failure_rows(recording: Recording) -> list[dict[str, Any]]:
    """The outermost failures of each tick: those that no parent handed on in the same tick."""
    rows = []
    for index, tick in enumerate(recording.ticks):
        for node, failure in _outermost(recording.nodes, tick):
            links = list(_links(recording.nodes, node, failure))
            rows.append({"tick": index, "node": node, "links": links})
    last = final_failure(recording)
    if last is not None and _of_root(recording) is None:
        end = max(i for i, tick in enumerate(recording.ticks) if not tick.settling)
        rows.append({"tick": end, "node": 0, "links": list(_links(recording.nodes, 0, last))})
    return rows


def final_failure(recording: Recording) -> FailureValue | None:
    """Why the run failed: the root's failure, or what no node had, such as `--max-time`."""
    if recording.report is None or not recording.ticks:
        return None
    told = report_of(recording.report).failure
    return None if told is None else _of_root(recording) or told


def _of_root(recording: Recording) -> FailureValue | None:
    """The root's failure in the tick that ended the run."""
    last = max((tick for tick in recording.ticks if not tick.settling), key=lambda tick: tick.now)
    found = [change.failure for change in last.changes if change.node == 0]
    return found[-1] if found else None


def _outermost(nodes: Sequence[NodeInfo], tick: TickRecord) -> Iterator[tuple[int, FailureValue]]:
    """A parent's line comes after its child's."""
    later: set[int] = set()
    found = []
    for change in reversed(tick.changes):
        if change.status == FAILURE:
            if change.failure is not None and nodes[change.node].parent not in later:
                found.append((change.node, change.failure))
            later.add(change.node)
    return reversed(found)


def _links(
    nodes: Sequence[NodeInfo], node: int, failure: FailureValue
) -> Iterator[Mapping[str, Any]]:
    """The failure, its causes and what was tried before, outermost first, as the page wants them.

    at: the node's index, -1 where it is not known.
    """
    stack = [(failure, 0, "", node, "")]
    for _ in range(_MOST_LINKS):
        if not stack:
            return
        link, depth, role, above, said = stack.pop()
        at = _node_of(nodes, link, above)
        file, _, line = link.place.rpartition(":")
        yield {
            "code": "" if str(link) == said else link.code,
            "message": "" if str(link) == said else link.message,
            "node": link.node or "the tree",
            "place": f"({PurePath(file).name}:{line})" if file else "",
            "tries": tries_text(link) if link.most_tries else "",
            "data": [[str(key), value_text(value)] for key, value in link.data.items()],
            "role": role,
            "depth": depth,
            "at": at,
        }
        inside = above if at < 0 else at
        if link.cause is not None:
            stack.append((link.cause, depth + 1, _CAUSE, inside, str(link)))
        stack.extend((f, depth + 1, _BESIDE, inside, "") for f in reversed(link.beside))


def _node_of(nodes: Sequence[NodeInfo], failure: FailureValue, near: int) -> int:
    """The node that failed: below `near`, or else below what is around that, and so on.

    A tree that is used several times has nodes with the same names and lines each time.
    """
    above: int | None = near
    while above is not None:
        for node in nodes[above:]:
            if node.index > above and node.depth <= nodes[above].depth:
                break
            if node.name == failure.node and node.place == failure.place:
                return node.index
        above = nodes[above].parent
    return -1

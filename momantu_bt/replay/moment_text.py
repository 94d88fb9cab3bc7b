"""A moment of a record as text and as JSON: the tree, what failed, the blackboard."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Any

from momantu_bt.engine.status import FAILURE, IDLE
from momantu_bt.failure import FailureValue
from momantu_bt.messages import plain
from momantu_bt.record.report import finite
from momantu_bt.record.text.failure import failure_line
from momantu_bt.record.text.lines import tree_lines
from momantu_bt.replay.difference import value_words
from momantu_bt.replay.moment import Moment, ShownNode


def moment_lines(moment: Moment) -> Iterator[str]:
    """Time, tree, what failed in this tick and blackboard, as plain text."""
    yield f"-- {moment.tick.now:.2f} s, tick {moment.tick.number}"
    for line in tree_lines(moment.root):
        yield f"{'  ' * line.depth}{line.text}  {line.status}"
    for failure in failures_of(moment):
        yield f"failed: {failure_line(failure)}"
    yield from (f"{mark} {words}" for mark, words in board_lines(moment))


def failures_of(moment: Moment) -> list[FailureValue]:
    """The failures of this tick, each at the topmost node it reached."""
    failed: dict[int, FailureValue] = {}
    for change in moment.tick.changes:
        if change.status == FAILURE.value and change.failure is not None:
            failed[change.node] = change.failure
    return [
        failure for node, failure in failed.items() if moment.nodes[node].info.parent not in failed
    ]


def board_lines(moment: Moment) -> Iterator[tuple[str, str]]:
    """Each key with its value. Those that this tick wrote come first, with the mark `*`.

    A key inside a subtree has the subtree's name before it. If several uses of a subtree have the
    key, the path from the root to the use is added.
    """
    short = {cell: "/".join(cell.split("/")[-2:]) for cell in moment.board}
    uses = Counter(short.values())
    written = set(moment.written)
    for cell in sorted(moment.board, key=lambda cell: (cell not in written, cell)):
        name = short[cell] if uses[short[cell]] == 1 else cell
        mark = "*" if cell in written else " "
        yield mark, f"{name} = {value_words(moment.board[cell])}"


def moment_data(moment: Moment) -> dict[str, Any]:
    """The moment as JSON data. Nodes that are IDLE are left out."""
    tick = moment.tick
    return {
        "tick": tick.number,
        "time": tick.now,
        "settling": tick.settling,
        "status": moment.root.shown.value,
        "changed": [change.node for change in tick.changes],
        "nodes": [_node_data(node) for node in moment.nodes if node.shown is not IDLE],
        "written": list(moment.written),
        "blackboard": finite(plain(dict(moment.board))),
    }


def _node_data(node: ShownNode) -> dict[str, Any]:
    info = node.info
    data: dict[str, Any] = {
        "index": info.index,
        "name": info.name,
        "type": info.type,
        "place": info.place,
        "label": node.label,
        "status": node.shown.value,
    }
    if node.note:
        data["note"] = node.note
    if node.shown is FAILURE and node.failure is not None:
        data["failure"] = finite(plain(node.failure.as_dict()))
    return data

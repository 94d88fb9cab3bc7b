"""Finding a moment of a record: by what changes, by a node, by a failure."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from momantu_bt.engine.role import Role
from momantu_bt.engine.status import FAILURE
from momantu_bt.errors import MomantuError
from momantu_bt.failure import FailureValue
from momantu_bt.formats.names import valid_names
from momantu_bt.record.recording import NodeInfo, Recording


class SeekError(MomantuError, ValueError):
    """The record has no such moment; the message says which moments it has."""


@dataclass(frozen=True, slots=True)
class FailureAt:
    """A node failed by itself. index: the tick's in the record."""

    index: int
    node: NodeInfo
    failure: FailureValue


def changes(recording: Recording) -> list[int]:
    """Indices of the ticks in which a status changed."""
    return [index for index, tick in enumerate(recording.ticks) if tick.changes]


def failures(recording: Recording) -> list[FailureAt]:
    """Every failure where it began. Nodes that only pass on a child's failure are left out."""
    found: list[FailureAt] = []
    for index, tick in enumerate(recording.ticks):
        below: set[int | None] = set()
        for change in tick.changes:
            if change.status != FAILURE.value:
                continue
            node = recording.nodes[change.node]
            if change.failure is not None and node.index not in below:
                found.append(FailureAt(index, node, change.failure))
            below.add(node.parent)
    return found


def matching(recording: Recording, wanted: str) -> list[NodeInfo]:
    """Nodes by their name, type or skill, or by their line in the tree's main file.

    Raises:
        SeekError: there is no such moment; the message names the nearest one.
    """
    if wanted.isdigit():
        return _in_line(recording, int(wanted))
    found = [node for node in recording.nodes if wanted in (node.name, node.type)]
    if not found:
        known = list(dict.fromkeys(w for node in recording.nodes for w in (node.name, node.type)))
        hint = valid_names(wanted, known, "nodes")
        raise SeekError(f"no node is called {wanted!r}; {hint}")
    return found


def _in_line(recording: Recording, line: int) -> list[NodeInfo]:
    main = str(recording.about["tree"])
    lines: dict[int, NodeInfo] = {}
    for node in recording.nodes:
        file, _, number = node.place.rpartition(":")
        if file == main and (lines.get(int(number)) or node).role is Role.STEPS:
            lines[int(number)] = node
        elif file == main:
            lines.setdefault(int(number), node)
    if line not in lines:
        near = min(lines, key=lambda each: abs(each - line))
        raise SeekError(f"no node begins in line {line}; one does in line {near}")
    return [lines[line]]


def changes_of(recording: Recording, nodes: Iterable[NodeInfo]) -> list[int]:
    """Indices of the ticks in which one of the nodes changed."""
    wanted = {node.index for node in nodes}
    return [
        index
        for index, tick in enumerate(recording.ticks)
        if any(change.node in wanted for change in tick.changes)
    ]


def following(indices: Sequence[int], index: int) -> int | None:
    """The first index after a given one."""
    return next((each for each in indices if each > index), None)


def preceding(indices: Sequence[int], index: int) -> int | None:
    """The last index before a given one."""
    return next((each for each in reversed(indices) if each < index), None)

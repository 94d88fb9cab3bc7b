"""The texts beside nodes: values in their lines, and notes that change while they run.

The journal of changes has neither: a line gets its values at a start, and a skill's phase or a
count of tries goes on without a change of status.
"""

from __future__ import annotations

from momantu_bt.engine.changes import SeenNode
from momantu_bt.engine.executor import Executor
from momantu_bt.engine.status import IDLE, RUNNING


class Captions:
    """`new` gives, tick by tick, what differs from what a reader of the record knows."""

    def __init__(self, run: Executor) -> None:
        self._running: dict[int, SeenNode] = {}
        self._notes: dict[int, str] = {}
        self._labels = {node.index: node.label for node in run.built.nodes}

    def new(self, run: Executor) -> tuple[list[tuple[int, str]], list[tuple[int, str]]]:
        """Notes and lines that are new, each with its node's index."""
        labels: list[tuple[int, str]] = []
        for node, status, note, _ in run.context.changes:
            index = node.index
            if status is RUNNING:
                self._running[index] = node
            else:
                self._running.pop(index, None)
            self._notes[index] = note
            if status is not IDLE and node.label != self._labels[index]:
                self._labels[index] = node.label
                labels.append((index, node.label))
        notes: list[tuple[int, str]] = []
        for index, node in self._running.items():
            note = node.note
            if note != self._notes[index]:
                self._notes[index] = note
                notes.append((index, note))
        return notes, labels

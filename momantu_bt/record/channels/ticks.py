"""Ticks as messages: what changed, was written, read and commanded, each value encoded once."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from typing import Any

from momantu_bt.engine.blackboard import Journal, written
from momantu_bt.engine.changes import Change, SeenNode
from momantu_bt.engine.executor import Executor
from momantu_bt.engine.skills.actuators import Issued
from momantu_bt.engine.status import IDLE, RUNNING
from momantu_bt.failure import FailureValue
from momantu_bt.messages import ActuatorGoal
from momantu_bt.record.channels.channel import stamp_of
from momantu_bt.record.codec import dumps, to_json, to_text
from momantu_bt.record.mcap.file import McapFile
from momantu_bt.record.mcap.schemas import TICK
from momantu_bt.record.outside_log import OutsideLog, Step

AGAIN = '{"$again":true}'
"""Stands for a value that is the same object as the last one under its name."""
_MOST_TEXTS = 10_000
"""Greatest number of changes and steps kept as text; a note with a count would add ever more."""


class Ticks:
    """Writes `/tick`. outside: what reached the tree from outside since the last tick."""

    def __init__(self, file: McapFile, outside: OutsideLog, run: Executor) -> None:
        self._channel = file.channel("/tick", "momantu.Tick", TICK)
        self._outside = outside
        self._captions = Captions(run)
        self._steps: dict[tuple[int, str, str], str] = {}
        self._changes: dict[tuple[int, str, str], str] = {}
        self._failures: dict[int, FailureValue] = {}
        self._failed: dict[int, int] = {}
        self._values: dict[str, tuple[Any, str]] = {}
        self._read: dict[str, Any] = {}
        self._goals: dict[str, ActuatorGoal] = {}
        self._quoted: dict[str, str] = {}

    def write(self, run: Executor, file: McapFile) -> None:
        """Write one tick. Before the first, write tick 0 with the initial values of the run."""
        context = run.context
        parts = [f'{{"number":{context.tick},"now":{context.now!r}']
        if context.changes:
            parts.append(f'"changes":[{",".join(map(self._change, context.changes))}]')
        if context.writes:
            parts.append(f'"writes":[{",".join(self._written(context.writes))}]')
        if self._outside.reads:
            parts.append(f'"reads":[{",".join(map(self._value_read, self._outside.reads))}]')
        if self._outside.steps:
            parts.append(f'"steps":[{",".join(map(self._step, self._outside.steps))}]')
        self._outside.clear()
        notes, labels = self._captions.new(run)
        if notes:
            parts.append(f'"notes":{dumps(notes)}')
        if labels:
            parts.append(f'"labels":{dumps(labels)}')
        if context.logs:
            logs = [(log.leaf.index, log.text) for log in context.logs]
            parts.append(f'"logs":{dumps(logs)}')
        if context.body is not None and context.body.actuators.issued:
            issued = map(self._issued, context.body.actuators.issued)
            parts.append(f'"issued":[{",".join(issued)}]')
        if run.fingerprint.state:
            digest = hashlib.blake2b(run.fingerprint.state, digest_size=8).hexdigest()
            parts.append(f'"state":"{digest}"')
        if run.settling:
            parts.append('"settling":true')
        file.add(self._channel, stamp_of(context.now), ",".join(parts) + "}")

    def _change(self, change: Change) -> str:
        """A change as JSON, kept because the same few changes recur."""
        node, status, note, failure = change
        if failure is not None:
            text = self._failure(node.index, failure)
            return f'[{node.index},"{status.value}",{dumps(note)},{text}]'
        key = (node.index, status.value, note)
        known = self._changes.get(key)
        if known is None:
            known = f'[{node.index},"{status.value}",{dumps(note)},null]'
            _keep(self._changes, key, known)
        return known

    def _failure(self, index: int, failure: FailureValue) -> str:
        """A failure as JSON; if it is a node's newest failure already, the index of that node."""
        of = self._failed.get(id(failure))
        if of is not None:
            return f'{{"$again":{of}}}'
        before = self._failures.get(index)
        if before is not None:
            del self._failed[id(before)]
        self._failures[index], self._failed[id(failure)] = failure, index
        return dumps(to_json(failure))

    def _written(self, journal: Journal) -> Iterable[str]:
        return [self._write(cell.name, value) for cell, value in written(journal)]

    def _write(self, name: str, value: Any) -> str:
        known = self._values.get(name)
        if known is None or known[0] is not value:
            known = (value, f"[{dumps(name)},{dumps(to_json(value))}]")
            self._values[name] = known
        return known[1]

    def _value_read(self, read: tuple[str, Any]) -> str:
        name, value = read
        if name in self._read and self._read[name] is value:
            return f"[{dumps(name)},{AGAIN}]"
        self._read[name] = value
        return f"[{dumps(name)},{dumps(to_json(value))}]"

    def _step(self, step: Step) -> str:
        """A step as JSON; most steps stay in the phase of the one before."""
        index = step.leaf.index
        if step.failure is not None or step.outputs:
            failure = "null" if step.failure is None else dumps(to_json(step.failure))
            outputs = {name: to_json(value) for name, value in step.outputs.items()}
            status = step.status.value
            return f'[{index},"{status}",{dumps(step.phase)},{failure},{dumps(outputs)}]'
        key = (index, step.status.value, step.phase)
        known = self._steps.get(key)
        if known is None:
            known = f'[{index},"{step.status.value}",{dumps(step.phase)},null,{{}}]'
            _keep(self._steps, key, known)
        return known

    def _issued(self, issued: Issued) -> str:
        """A goal as JSON; a trajectory that is commanded again is only named."""
        name, goal = issued.actuator, issued.goal
        quoted = self._quoted.get(name)
        if quoted is None:
            quoted = self._quoted[name] = dumps(name)
        if goal is None:
            self._goals.pop(name, None)
            return f"[{quoted},null]"
        if self._goals.get(name) is goal:
            return f"[{quoted},{AGAIN}]"
        self._goals[name] = goal
        return f"[{quoted},{to_text(goal)}]"


def _keep(texts: dict[tuple[int, str, str], str], key: tuple[int, str, str], text: str) -> None:
    if len(texts) >= _MOST_TEXTS:
        texts.clear()
    texts[key] = text


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

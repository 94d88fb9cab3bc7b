"""Ticking the tree of a recorded run again without its world: it must do the same.

Skills, services, odometry and people give the recorded results and answers. Every other node
really runs, by the recorded clock. Each tick's changes and writes are compared.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from momantu_bt.engine.blackboard import Board, ReadOnlyCell, written
from momantu_bt.engine.build import build
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.executor import halt_tree
from momantu_bt.engine.outside import PERSON, POSITION, SPEED
from momantu_bt.engine.status import RUNNING, Status
from momantu_bt.record.recording import ChangeRecord, Recording, TickRecord
from momantu_bt.replay.difference import NOTHING, Difference, first_difference, node_words
from momantu_bt.replay.outside import NotRecorded, RecordedOutside
from momantu_bt.replay.rebuild import Rebuilt, rebuild
from momantu_bt.tree.check.root_keys import ROBOT_KEY
from momantu_bt.tree.registry import Registry
from momantu_bt.values.convert import natural

_SERVICES = "/service/"


@dataclass(frozen=True, slots=True)
class Recheck:
    """The result. ticks: the number of equal ticks. difference: the first differing one.

    In the difference, `left` is what the record has and `right` is what the tree does here.
    """

    ticks: int
    difference: Difference | None


def recheck(recording: Recording, registry: Registry) -> Recheck:
    """Tick a record's tree again.

    Raises:
        RebuildError: the tree cannot be rebuilt here.
        PluginError: one of the skills cannot be loaded.
    """
    replica = _Replica(recording, rebuild(recording, registry), registry)
    difference = replica.tree_difference()
    done = 0
    for number, tick in enumerate(recording.ticks):
        difference = difference or replica.tick(tick, last=_is_last(recording, number))
        if difference is not None:
            break
        done += not tick.settling and tick.number > 0
    return Recheck(done, difference)


def _is_last(recording: Recording, number: int) -> bool:
    """Whether the tree has no more ticks after this one."""
    following = recording.ticks[number + 1 : number + 2]
    return not following or following[0].settling


class _Clock:
    time = 0.0

    def now(self) -> float:
        """The recorded time of the tick."""
        return self.time


class _Replica:
    """The tree of a record, built again."""

    def __init__(self, recording: Recording, made: Rebuilt, registry: Registry) -> None:
        self._nodes = recording.nodes
        self._clock = _Clock()
        self._outside = RecordedOutside()
        self._context = RunContext(self._clock, outside=self._outside)
        board = Board(self._context.writes)
        for key in _published(recording):
            board.publish(ReadOnlyCell(key, self._asking(key)))
        given = {key: literal.value for key, literal in made.document.values.items()}
        for key, value in (given | dict(made.substitution.values)).items():
            board.cell(key).store(natural(value))
        self._built = build(
            made.document, self._context, registry.skills.__getitem__, board, made.substitution
        )
        self._halted = False

    def _asking(self, key: str) -> Callable[[], Any]:
        return lambda: self._outside.ask(key, lambda: None)

    def tree_difference(self) -> Difference | None:
        """Whether the tree has other nodes than the recorded tree."""
        here = [(node.name, node.model.target or node.model.type) for node in self._built.nodes]
        for index in range(max(len(here), len(self._nodes))):
            left = self._nodes[index] if index < len(self._nodes) else None
            right = self._built.nodes[index] if index < len(here) else None
            if left is None or right is None or (left.name, left.type) != here[index]:
                words = NOTHING if left is None else node_words(left)
                other = NOTHING if right is None else right.where
                return Difference(0, 0.0, "tree", f"node {index}", words, other)
        return None

    def tick(self, tick: TickRecord, *, last: bool) -> Difference | None:
        """Do what the run did in this tick. Returns the first thing that differs."""
        context = self._context
        if tick.settling:
            context.changes.clear()
            context.writes.clear()
            if not self._halted:
                self._halted = True
                halt_tree(self._built)
            return self._compared(tick)
        if tick.number == 0:
            return self._compared(tick)
        self._clock.time = tick.now
        self._outside.load(tick, last=last)
        context.begin_tick()
        try:
            status = self._built.root.execute()
        except NotRecorded as missing:
            return self._unlike(tick, "outside", missing.node, NOTHING, missing.what)
        except Exception as error:  # the run raised none here
            return self._unlike(tick, "error", 0, NOTHING, f"{type(error).__name__}: {error}")
        return self._compared(tick) or self._left_over(tick) or self._ended(tick, status, last)

    def _compared(self, tick: TickRecord) -> Difference | None:
        changes = tuple(
            ChangeRecord(change.node.index, change.status.value, change.note, change.failure)
            for change in self._context.changes
        )
        writes = tuple((cell.name, value) for cell, value in written(self._context.writes))
        here = replace(tick, changes=changes, writes=writes)
        return first_difference(tick, here, self._nodes, surroundings=False)

    def _left_over(self, tick: TickRecord) -> Difference | None:
        left = self._outside.left_over()
        return None if left is None else self._unlike(tick, "outside", left[1], left[0], NOTHING)

    def _ended(self, tick: TickRecord, status: Status, last: bool) -> Difference | None:
        if last or status is RUNNING:
            return None
        return self._unlike(tick, "end", 0, RUNNING.value, status.value)

    def _unlike(
        self, tick: TickRecord, kind: str, node: int | None, left: str, right: str
    ) -> Difference:
        where = "" if node is None else node_words(self._nodes[node])
        return Difference(tick.number, tick.now, kind, where, left, right)


def _published(recording: Recording) -> list[str]:
    """The read-only keys of the run, as far as the record shows them."""
    read = {key for tick in recording.ticks for key, _ in tick.reads}
    running = {t.removeprefix(_SERVICES) for t in recording.topics() if t.startswith(_SERVICES)}
    robot = set() if recording.about["robot"] is None else {ROBOT_KEY}
    return sorted((read | running | robot) - {PERSON, POSITION, SPEED})

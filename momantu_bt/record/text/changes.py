"""Write a run as plain lines: one for each change that matters to a reader."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import groupby
from typing import Protocol, TypeAlias

from momantu_bt.engine.executor import Executor
from momantu_bt.engine.role import Role
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, Status
from momantu_bt.failure import FailureValue
from momantu_bt.record.text.failure import failure_line

_WORDS = {"RUNNING": "starts", "SUCCESS": "done", "IDLE": "halted", "SKIPPED": "skipped"}


_GUARDS = (Role.PLAIN, Role.AROUND)
"""Roles of nodes that have no lines of their own."""


class ReportedNode(Protocol):
    """A node of a run, or of its record."""

    @property
    def index(self) -> int:
        """Its number in the order of the file."""
        ...

    @property
    def name(self) -> str:
        """Its name."""
        ...

    @property
    def label(self) -> str:
        """The node in one line."""
        ...

    @property
    def role(self) -> Role:
        """Its role for a reader."""
        ...

    @property
    def above(self) -> ReportedNode | None:
        """The node around it."""
        ...


StatusChange: TypeAlias = tuple[ReportedNode, Status, str, FailureValue | None]
"""A node, its new status, its note and why it failed; a `Change` is one."""


class ChangeLines:
    """Says when a skill or a subtree starts and ends, and what a recovery does about a failure.

    say: takes one line at a time. say_trouble: takes the lines of failures and of what is done
    about them, and what skills log; by default `say`.
    """

    def __init__(
        self, say: Callable[[str], None], say_trouble: Callable[[str], None] | None = None
    ) -> None:
        self._say = say
        self._say_trouble = say_trouble or say
        self._was_running: set[int] = set()
        self._notes: dict[int, str] = {}

    def ticked(self, run: Executor) -> None:
        """Print this tick's changes."""
        self.print_changes(run.context.now, run.context.changes, run.context.logs)

    def print_changes(
        self,
        now: float,
        changes: Iterable[StatusChange],
        logs: Iterable[tuple[ReportedNode, str]] = (),
    ) -> None:
        """Print the changes of one tick of a run or of a record, and what skills have logged.

        What a skill logs comes after its start and before its end.
        """
        waiting = list(logs)
        guards: list[tuple[ReportedNode, FailureValue]] = []
        for node, status, note, failure in _parents_first(changes):
            if status is FAILURE and failure is not None and node.role in _GUARDS:
                guards.append((node, failure))
            if waiting and status is not RUNNING:
                self._tell_logs(now, [log for log in waiting if log[0].index == node.index])
                waiting = [log for log in waiting if log[0].index != node.index]
            if node.role is Role.RECOVERY:
                self._tell_guard(now, node, note, guards)
                self._tell_note(now, node, note)
            elif node.role is Role.ACT or node.role is Role.TREE:
                self._tell(now, node, status, failure)
        self._tell_logs(now, waiting)

    def _tell_logs(self, now: float, logs: Iterable[tuple[ReportedNode, str]]) -> None:
        for node, text in logs:
            self._line(now, node, f"  {node.name}: {text}", matters=True)

    def close(self) -> None:
        """Nothing is left to say."""

    def _tell(
        self, now: float, node: ReportedNode, status: Status, failure: FailureValue | None
    ) -> None:
        running = node.index in self._was_running
        self._was_running.discard(node.index)
        if status is RUNNING:
            self._was_running.add(node.index)
        if status is IDLE and not running:
            return
        words = f"fails: {_reason(node, failure)}" if status is FAILURE else _WORDS[status.value]
        self._line(now, node, f"{node.label} {words}", matters=status is FAILURE)

    def _tell_guard(
        self,
        now: float,
        recovery: ReportedNode,
        note: str,
        guards: list[tuple[ReportedNode, FailureValue]],
    ) -> None:
        """Print why a guard failed, if a recovery handles that: guards have no lines otherwise."""
        code, colon, _ = note.partition(": ")
        caught = [(n, f) for n, f in guards if _is_below(n, recovery) and f.cause is None]
        guards.clear()
        if not colon or not caught or caught[-1][1].code != code:
            return
        last = caught[-1][1].message  # nodes around the guard have failed with the same words
        node, failure = next((n, f) for n, f in caught if f.message == last)
        words = f"{node.label} fails: {failure_line(failure).partition(' <- ')[0]}"
        self._line(now, node, words, matters=True)

    def _tell_note(self, now: float, node: ReportedNode, note: str) -> None:
        before = self._notes.get(node.index, "")
        self._notes[node.index] = note
        if note not in (before, "", "try 1") and not note.startswith("try 1 of "):
            self._line(now, node, f"{node.name}: {note}", matters=True)

    def _line(self, now: float, node: ReportedNode, words: str, *, matters: bool = False) -> None:
        say = self._say_trouble if matters else self._say
        say(f"{now:8.2f} s {'  ' * _level(node)}{words}")


def _parents_first(changes: Iterable[StatusChange]) -> Iterator[StatusChange]:
    """Put nodes that start in one tick in file order; they arrive with the innermost first."""
    for starting, group in groupby(changes, key=lambda change: change[1] is RUNNING):
        together = list(group)
        yield from sorted(together, key=lambda change: change[0].index) if starting else together


def _is_below(node: ReportedNode, other: ReportedNode) -> bool:
    above = node.above
    while above is not None and above.index != other.index:
        above = above.above
    return above is not None


def _level(node: ReportedNode) -> int:
    """The number of subtrees around it."""
    level, above = 0, node.above
    while above is not None:
        level, above = level + (above.role is Role.TREE), above.above
    return level


def _reason(node: ReportedNode, failure: FailureValue | None) -> str:
    if failure is None:
        return "FAILED"
    if node.role is Role.TREE:
        return failure.code
    return failure_line(failure).partition(" <- ")[0]

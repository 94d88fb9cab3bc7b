"""A run as plain lines: one for each change that a person would tell."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import groupby

from momantu_bt.engine.context import Change
from momantu_bt.engine.executor import Executor
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.nodes.asking import Ask, Confirm
from momantu_bt.engine.nodes.recovery import Recover
from momantu_bt.engine.nodes.skill import SkillLeaf
from momantu_bt.engine.nodes.substituted import Substituted
from momantu_bt.engine.nodes.subtree import SubTree
from momantu_bt.engine.nodes.timing import Sleep
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, Status
from momantu_bt.failure import FailureValue
from momantu_bt.record.chain import chain_text

_WORDS = {"RUNNING": "starts", "SUCCESS": "done", "IDLE": "halted", "SKIPPED": "skipped"}
_TOLD = (SkillLeaf, SubTree, Sleep, Ask, Confirm, Substituted)


class ChangeLines:
    """Says when a skill or a subtree starts and ends, and what a recovery does about a failure.

    say: takes one line at a time.
    """

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say = say
        self._was_running: set[int] = set()
        self._notes: dict[int, str] = {}

    def ticked(self, run: Executor) -> None:
        """Tell this tick's changes."""
        for node, status, note, failure in _parents_first(run.context.changes):
            if isinstance(node, Recover):
                self._tell_note(run.context.now, node, note)
            elif isinstance(node, _TOLD):
                self._tell(run.context.now, node, status, failure)

    def close(self) -> None:
        """Nothing is left to say."""

    def _tell(
        self, now: float, node: TreeNode, status: Status, failure: FailureValue | None
    ) -> None:
        running = node.index in self._was_running
        self._was_running.discard(node.index)
        if status is RUNNING:
            self._was_running.add(node.index)
        if status is IDLE and not running:
            return
        words = f"fails: {_reason(node, failure)}" if status is FAILURE else _WORDS[status.value]
        self._line(now, node, f"{node.label} {words}")

    def _tell_note(self, now: float, node: Recover, note: str) -> None:
        before = self._notes.get(node.index, "try 1")
        self._notes[node.index] = note
        if note not in (before, "try 1", ""):
            self._line(now, node, f"{node.name}: {note}")

    def _line(self, now: float, node: TreeNode, words: str) -> None:
        self._say(f"{now:8.2f} s {'  ' * _level(node)}{words}")


def _parents_first(changes: Iterable[Change]) -> Iterator[Change]:
    """Nodes that start in one tick in the order of the file, though the innermost is first."""
    for starting, group in groupby(changes, key=lambda change: change.status is RUNNING):
        together = list(group)
        yield from sorted(together, key=lambda c: c.node.index) if starting else together


def _level(node: TreeNode) -> int:
    """How many subtrees it is in."""
    parent = node.parent
    above = _level(parent) if isinstance(parent, TreeNode) else 0
    return above + isinstance(parent, SubTree)


def _reason(node: TreeNode, failure: FailureValue | None) -> str:
    if failure is None:
        return "FAILED"
    if isinstance(node, SubTree):
        return failure.code
    return chain_text(failure).partition(" <- ")[0]

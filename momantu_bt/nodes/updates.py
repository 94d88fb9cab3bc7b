"""WasEntryUpdated, SkipUnlessUpdated, WaitValueUpdate: react to a key that was written.

Each node remembers the last write that it has seen, also when it ends or is halted. The first time
it looks, a key that has a value counts as written. A key without a value never does.
"""

from __future__ import annotations

from typing import ClassVar

from momantu_bt.engine.blackboard import Cell
from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.status import RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.failure import FAILED
from momantu_bt.skill import MISSING
from momantu_bt.tree.catalogue.flow import After, Walk, as_child
from momantu_bt.tree.catalogue.known import Known, meet
from momantu_bt.tree.catalogue.spec import decorator, input_port, leaf
from momantu_bt.tree.catalogue.wording import port_text
from momantu_bt.tree.model import Node


class Watch:
    """Looks at one cell and remembers what it has seen."""

    def __init__(self, cell: Cell) -> None:
        self.cell = cell
        self.seen = 0

    def is_new(self) -> bool:
        """Whether the cell has a value that was written since the last time."""
        if self.cell.value is MISSING:
            return False
        before, self.seen = self.seen, self.cell.writes
        return self.seen != before


_ENTRY = input_port("entry", object, "the key that is watched")


def _unless_skipped(walk: Walk, node: Node, before: Known) -> After:
    end = as_child(walk, node, before)
    return After(end.success, end.failure, meet(end.skipped, before))


class WasEntryUpdated(TreeNode):
    """SUCCESS when the key was written since this node last looked, else FAILURE."""

    spec = leaf(
        "WasEntryUpdated",
        "was_entry_updated",
        "Succeeds when a key was written since the last time, fails when it was not.",
        _ENTRY,
        keys=("entry",),
        may_be_empty=("entry",),
        condition=True,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.watch = Watch(parts.key("entry"))

    def step(self) -> Status:
        """Check whether the key was written."""
        if self.watch.is_new():
            return SUCCESS
        return self.fail(FAILED, f"${self.watch.cell.name} has not been written")


class SkipUnlessUpdated(Decorator):
    """Starts the child when the key was written, and ticks it until it ends; otherwise SKIPPED."""

    spec = decorator(
        "SkipUnlessUpdated",
        "skip_unless_updated",
        "Runs the child when a key was written since the last time; is skipped otherwise.",
        _ENTRY,
        keys=("entry",),
        may_be_empty=("entry",),
        flow=_unless_skipped,
        around=lambda node: f"only when {port_text(node, 'entry')} is new",
    )

    instead: ClassVar[Status] = SKIPPED

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.watch = Watch(parts.key("entry"))
        self.at_work = False

    def step(self) -> Status:
        """Tick the child, or return `instead` while the key has no new value."""
        if not self.at_work and not self.watch.is_new():
            return self.instead
        status = self.child.execute()
        self.at_work = status is RUNNING
        if status.completed:
            self.child.reset()
        return self.pass_on(status)

    def clear(self) -> None:
        """Forget that the child was running."""
        self.at_work = False


class WaitValueUpdate(SkipUnlessUpdated):
    """As `SkipUnlessUpdated`, but returns RUNNING while it waits for a write."""

    spec = decorator(
        "WaitValueUpdate",
        "wait_value_update",
        "Waits until a key is written, then runs the child.",
        _ENTRY,
        keys=("entry",),
        may_be_empty=("entry",),
        flow=as_child,
        around=lambda node: f"waits until {port_text(node, 'entry')} is written",
    )

    instead = RUNNING

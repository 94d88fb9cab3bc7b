"""WasEntryUpdated, SkipUnlessUpdated, WaitValueUpdate: has a key been written since the last time.

A key that has a value counts as written the first time it is looked at; one that has none never
does. What was seen outlasts an end and a halt.
"""

from __future__ import annotations

from typing import Any, ClassVar

from momantu_bt.engine.blackboard import Cell
from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.status import RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.failure import FAILED
from momantu_bt.skill import MISSING


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


class WasEntryUpdated(TreeNode):
    """SUCCESS when the key was written since this node last looked, else FAILURE."""

    def __init__(self, *arguments: Any, entry: Cell, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.watch = Watch(entry)

    def step(self) -> Status:
        """Look."""
        if self.watch.is_new():
            return SUCCESS
        return self.fail(FAILED, f"${self.watch.cell.name} has not been written")


class SkipUnlessUpdated(Decorator):
    """Ticks a child that is at work; otherwise starts it when the key was written."""

    instead: ClassVar[Status] = SKIPPED

    def __init__(self, *arguments: Any, entry: Cell, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.watch = Watch(entry)
        self.at_work = False

    def step(self) -> Status:
        """Tick the child, or `instead`."""
        if not self.at_work and not self.watch.is_new():
            return self.instead
        status = self.child.execute()
        self.at_work = status is RUNNING
        if not self.at_work:
            self.child.reset()
        return self.pass_on(status)

    def clear(self) -> None:
        """The child has been halted."""
        self.at_work = False


class WaitValueUpdate(SkipUnlessUpdated):
    """The same, but RUNNING while it waits."""

    instead = RUNNING

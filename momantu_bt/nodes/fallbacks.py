"""Fallback, AsyncFallback, RoundRobin: children in turn until one succeeds.

| child returns | Fallback                              |
|---------------|---------------------------------------|
| RUNNING       | RUNNING                               |
| SUCCESS       | SUCCESS, back to the first            |
| FAILURE       | the next child; at the end FAILURE    |
| SKIPPED       | the next child; SKIPPED when all were |

It fails with the failure of the last child; the earlier failures are listed in its `beside`.
AsyncFallback returns RUNNING between two children. RoundRobin starts with the child after the one
with which it ended last time.
"""

from __future__ import annotations

from typing import ClassVar

from momantu_bt.engine.causes import with_beside
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.status import IDLE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.failure import FailureValue
from momantu_bt.tree.catalogue.flow import After, Walk, again, until_success
from momantu_bt.tree.catalogue.known import NEVER, Known, meet
from momantu_bt.tree.catalogue.spec import Dialect, control, input_port
from momantu_bt.tree.model import Node


class Fallback(TreeNode):
    """While RUNNING it continues with the current child; after its end it starts with the first."""

    spec = control(
        "Fallback", "fallback", "Children in turn until one succeeds.", flow=until_success
    )

    pauses: ClassVar[bool] = False
    at = 0
    skipped = 0

    def step(self) -> Status:
        """Tick the current child and those after it."""
        if self.state is IDLE:
            self.skipped = 0
        if self.at == 0:
            self.failures_seen: list[FailureValue] = []
        self.state = RUNNING
        while self.at < len(self.kids):
            child = self.kids[self.at]
            fresh = child.state is IDLE
            status = child.execute()
            if status is RUNNING:
                return RUNNING
            if status is SUCCESS:
                self.reset_children()
                self.at = 0
                return SUCCESS
            self.at += 1
            if status is SKIPPED:
                self.skipped += 1
                continue
            self.failures_seen.append(self.failure_of(child))
            if self.pauses and fresh and self.at < len(self.kids):
                return RUNNING
        all_skipped = self.skipped == len(self.kids)
        self.reset_children()
        self.at = self.skipped = 0
        if all_skipped:
            return SKIPPED
        return self.fail_with(with_beside(self.failures_seen))

    def clear(self) -> None:
        """Start with the first child again."""
        self.at = self.skipped = 0


class AsyncFallback(Fallback):
    """A fallback that returns RUNNING between two children."""

    spec = control(
        "AsyncFallback",
        "async_fallback",
        "A fallback that can be interrupted between two children.",
        flow=until_success,
    )

    pauses = True


def _any_first(walk: Walk, node: Node, before: Known) -> After:
    ends = [walk(child, before) for child in node.children]
    skipped = before if any(end.skipped.reached for end in ends) else NEVER
    return After(meet(NEVER, *(end.success for end in ends)), before, skipped)


class RoundRobin(TreeNode):
    """Runs one child; each start begins with the next one.

    When a child succeeds, the node succeeds, and the next start begins with the child after it.
    When a child fails or is skipped, the child after it is ticked; a skipped child is tried again
    in a later tick. When all children have failed or are skipped, the node fails with the last
    failure, and the next start begins with the first child. So it does after a halt. Without
    `wrap_around` the node does not go from the last child to the first.
    """

    spec = control(
        "RoundRobin",
        "round_robin",
        "Starts with the next child each time; a child that fails hands on to the one after it.",
        input_port("wrap_around", bool, "after the last child comes the first", True),
        dialect=Dialect.NAV2,
        flow=again(_any_first),
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.at = 0
        self.failures_seen: list[FailureValue] = []

    def step(self) -> Status:
        """Tick the current child, and the ones after it while they fail."""
        wraps: bool = self.inputs["wrap_around"]
        self.state = RUNNING
        skipped = 0
        while len(self.failures_seen) + skipped < len(self.kids):
            child = self.kids[self.at]
            status = child.execute()
            if status is RUNNING:
                return RUNNING
            self.at = (self.at + 1) % len(self.kids)
            if status is SUCCESS:
                self.failures_seen.clear()
                self.reset_children()
                return SUCCESS
            if status is SKIPPED:
                skipped += 1
            else:
                self.failures_seen.append(self.failure_of(child))
            if self.at == 0 and not wraps:
                break
        failures = list(self.failures_seen)
        self.reset_children()
        self.clear()
        if failures:
            return self.fail_with(with_beside(failures))
        self.state = IDLE
        return SKIPPED

    def clear(self) -> None:
        """Begin with the first child again."""
        self.at = 0
        self.failures_seen.clear()

    def renew(self) -> None:
        """Begin with the first child again."""
        self.clear()

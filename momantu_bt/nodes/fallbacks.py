"""Fallback, AsyncFallback, RoundRobin: children in turn until one succeeds.

| child returns | Fallback                              |
|---------------|---------------------------------------|
| RUNNING       | RUNNING                               |
| SUCCESS       | SUCCESS, back to the first            |
| FAILURE       | the next child; at the end FAILURE    |
| SKIPPED       | the next child; SKIPPED when all were |

It fails with the last failure; those before stand beside it. AsyncFallback returns RUNNING
between two children. RoundRobin starts with the child after the one that ended it last time.
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
    """Goes on where it was; starts over after its end."""

    spec = control(
        "Fallback", "fallback", "Children in turn until one succeeds.", flow=until_success
    )

    pauses: ClassVar[bool] = False
    at = 0
    skipped = 0

    def step(self) -> Status:
        """Tick children from the current one on."""
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
        """Back to the first child."""
        self.at = self.skipped = 0


class AsyncFallback(Fallback):
    """A fallback that lets a tick pass between two children."""

    spec = control(
        "AsyncFallback",
        "async_fallback",
        "A fallback that can be interrupted in between.",
        flow=until_success,
    )

    pauses = True


def _any_first(walk: Walk, node: Node, before: Known) -> After:
    ends = [walk(child, before) for child in node.children]
    skipped = before if any(end.skipped.reached for end in ends) else NEVER
    return After(meet(NEVER, *(end.success for end in ends)), before, skipped)


class RoundRobin(TreeNode):
    """One child at a time, each start the next one.

    A child's SUCCESS is its own, and next time the one after it begins. A FAILURE hands on to
    the child after, and so does a child that is skipped, which is asked again in a later tick.
    When all have failed (or are skipped) it fails with the last failure, and next time begins
    with the first, as after a halt. Without `wrap_around` nothing comes after the last child.
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

"""Sequence, AsyncSequence, SequenceWithMemory: children in turn until one fails.

| child returns | Sequence                      | SequenceWithMemory               |
|---------------|-------------------------------|----------------------------------|
| RUNNING       | RUNNING                       | RUNNING                          |
| SUCCESS       | the next child; at the end SUCCESS | the next child, in the next tick |
| FAILURE       | FAILURE, back to the first    | FAILURE, stays at this child     |
| SKIPPED       | the next child; SKIPPED when all were | the same                 |

AsyncSequence returns RUNNING between two children, so that what is around it can interrupt.
"""

from __future__ import annotations

from typing import ClassVar

from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.role import Role
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.tree.catalogue.flow import in_turn
from momantu_bt.tree.catalogue.spec import control


class Sequence(TreeNode):
    """Goes on where it was; starts over after a failure."""

    spec = control(
        "Sequence",
        "sequence",
        "Children in turn until one fails; goes on where it was.",
        flow=in_turn,
        in_turn=True,
    )

    pauses: ClassVar[bool] = False
    at = 0
    skipped = 0

    @property
    def role(self) -> Role:
        """A list of steps is a frame; its variants are nodes like others."""
        if type(self) is not Sequence:
            return Role.PLAIN
        return Role.STEPS if self.model.name is None else Role.NAMED_STEPS

    def step(self) -> Status:
        """Tick children from the current one on."""
        if self.state is IDLE:
            self.skipped = 0
        self.state = RUNNING
        kids = self.kids
        while self.at < len(kids):
            child = kids[self.at]
            fresh = child.state is IDLE
            status = child.execute()
            if status is RUNNING:
                return RUNNING
            if status is FAILURE:
                return self._failed(child)
            self.at += 1
            if status is SKIPPED:
                self.skipped += 1
            elif self.pauses and fresh and self.at < len(kids):
                return RUNNING
        all_skipped = self.skipped == len(kids)
        self.reset_children()
        self.at = self.skipped = 0
        return SKIPPED if all_skipped else SUCCESS

    def clear(self) -> None:
        """Back to the first child."""
        self.at = self.skipped = 0

    def _failed(self, child: TreeNode) -> Status:
        failure = self.failure_of(child)
        self.reset_children()
        self.at = 0
        return self.fail_with(failure)


class AsyncSequence(Sequence):
    """A sequence that lets a tick pass between two children."""

    spec = control(
        "AsyncSequence",
        "async_sequence",
        "A sequence that can be interrupted in between.",
        flow=in_turn,
        in_turn=True,
    )

    pauses = True


class SequenceWithMemory(Sequence):
    """A sequence that, after a failure or a halt, starts again at the child it had reached."""

    spec = control(
        "SequenceWithMemory",
        "sequence_with_memory",
        "A sequence that starts again at the child that failed.",
        flow=in_turn,
        in_turn=True,
    )

    pauses = True

    def clear(self) -> None:
        """Keep the place; that is its memory."""

    def renew(self) -> None:
        """Back to the first child."""
        self.at = self.skipped = 0

    def _failed(self, child: TreeNode) -> Status:
        failure = self.failure_of(child)
        self.reset_children()
        return self.fail_with(failure)

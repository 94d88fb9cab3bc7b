"""Sequence, AsyncSequence, SequenceWithMemory: children in turn until one fails.

| child returns | Sequence                      | SequenceWithMemory               |
|---------------|-------------------------------|----------------------------------|
| RUNNING       | RUNNING                       | RUNNING                          |
| SUCCESS       | the next child; at the end SUCCESS | the next child, in the next tick |
| FAILURE       | FAILURE, back to the first    | FAILURE, stays at this child     |
| SKIPPED       | the next child; SKIPPED when all were | the same                 |

AsyncSequence returns RUNNING between two children, so that nodes above it can interrupt it.
"""

from __future__ import annotations

from typing import ClassVar

from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.role import Role
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.tree.catalogue.flow import in_turn
from momantu_bt.tree.catalogue.spec import control


class Sequence(TreeNode):
    """While RUNNING it continues with the current child; after its end it starts over."""

    spec = control(
        "Sequence",
        "sequence",
        "Runs its children in turn until one fails; continues with the child that was running.",
        flow=in_turn,
        in_turn=True,
    )

    pauses: ClassVar[bool] = False
    at = 0
    skipped = 0

    @property
    def role(self) -> Role:
        """Its role in displays: a plain list of steps; the variants are ordinary nodes."""
        if type(self) is not Sequence:
            return Role.PLAIN
        return Role.STEPS if self.model.name is None else Role.NAMED_STEPS

    def step(self) -> Status:
        """Tick the current child and those after it."""
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
    """A sequence that returns RUNNING between two children."""

    spec = control(
        "AsyncSequence",
        "async_sequence",
        "A sequence that can be interrupted between two children.",
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
        """Keep the current child; a halt does not reset it."""

    def renew(self) -> None:
        """Back to the first child."""
        self.reset_children()
        self.at = self.skipped = 0

    def _failed(self, child: TreeNode) -> Status:
        """Reset the children from the failed one on; those before it stay as they ended."""
        failure = self.failure_of(child)
        for each in self.kids[self.at :]:
            each.reset()
        return self.fail_with(failure)

"""IfThenElse and WhileDoElse: one child decides which of the others runs.

IfThenElse ticks the condition until it ends, then keeps to the chosen branch. WhileDoElse ticks
the condition on each tick; when the choice changes it halts the other branch. Without an else
branch, the node fails when the condition fails. When the condition is skipped, the node returns
SKIPPED.
"""

from __future__ import annotations

from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.tree.catalogue.flow import After, Walk, again
from momantu_bt.tree.catalogue.known import NEVER, Known, meet
from momantu_bt.tree.catalogue.spec import control
from momantu_bt.tree.model import Node


def _branches(walk: Walk, node: Node, before: Known) -> After:
    if not node.children:
        return After(before, before)
    asked = walk(node.children[0], before)
    starts = (asked.success, asked.failure)
    ends = [walk(c, known) for c, known in zip(node.children[1:3], starts, strict=False)]
    failures = [end.failure for end in ends]
    if len(ends) < 2:
        failures.append(asked.failure)
    skipped = meet(asked.skipped, *(end.skipped for end in ends))
    return After(meet(NEVER, *(end.success for end in ends)), meet(*failures), skipped)


class IfThenElse(TreeNode):
    """Children: `if` (0), `then` (1) and, optionally, `else` (2)."""

    spec = control(
        "IfThenElse",
        "if",
        "Asks the first child once, then runs the second or the third.",
        children=(2, 3),
        positions=("if", "then", "else"),
        flow=_branches,
        title="if",
    )

    branch = 0

    def step(self) -> Status:
        """Tick the condition while no branch is chosen; then tick the branch."""
        self.state = RUNNING
        if self.branch == 0:
            asked = self.kids[0].execute()
            if asked is RUNNING:
                return RUNNING
            if asked is SKIPPED:
                self.reset_children()
                return SKIPPED
            if asked is FAILURE and len(self.kids) == 2:
                return self.fail_with(self.failure_of(self.kids[0]))
            self.branch = 1 if asked is SUCCESS else 2
        child = self.kids[self.branch]
        status = child.execute()
        if status is RUNNING:
            return RUNNING
        if status is FAILURE:
            self.fail_with(self.failure_of(child))
        self.reset_children()
        self.branch = 0
        return status

    def clear(self) -> None:
        """Forget which branch was chosen."""
        self.branch = 0


class WhileDoElse(TreeNode):
    """Children: the condition (0), the branch while it holds (1), the branch while it fails (2)."""

    spec = control(
        "WhileDoElse",
        "while_do",
        "Asks the first child on each tick and runs the second or the third.",
        children=(2, 3),
        positions=("while_do", "do", "else"),
        flow=again(_branches),
        title="while",
    )

    def step(self) -> Status:
        """Tick the condition, halt the other branch, tick the chosen one."""
        self.state = RUNNING
        condition, *branches = self.kids
        asked = condition.execute()
        if asked is RUNNING:
            return RUNNING
        status = SKIPPED
        if asked is not SKIPPED:
            meant = 0 if asked is SUCCESS else 1
            if len(branches) == 2:
                branches[1 - meant].reset()
            deciding = branches[meant] if meant < len(branches) else condition
            status = asked if deciding is condition else deciding.execute()
            if status is FAILURE:
                self.fail_with(self.failure_of(deciding))
        if status is RUNNING:
            return RUNNING
        self.reset_children()
        return status

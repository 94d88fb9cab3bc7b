"""The base class of decorators."""

from __future__ import annotations

from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.role import Role
from momantu_bt.engine.status import FAILURE, IDLE, SUCCESS, Status


class Decorator(TreeNode):
    """A node around one child. An end that the child is left with is cleared after each tick."""

    @property
    def role(self) -> Role:
        """It is drawn with its child."""
        return Role.AROUND

    @property
    def child(self) -> TreeNode:
        """The one child."""
        return self.kids[0]

    def execute(self) -> Status:
        """Tick, then clear the child's end, so that its conditions are asked again."""
        new = super().execute()
        child = self.kids[0]
        if child.state is SUCCESS or child.state is FAILURE:
            child.state = IDLE
        return new

    def pass_on(self, status: Status) -> Status:
        """The child's status as this node's own, its failure included."""
        if status is FAILURE:
            return self.fail_with(self.failure_of(self.child))
        return status

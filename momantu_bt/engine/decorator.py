"""The base class of decorators."""

from __future__ import annotations

from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.role import Role
from momantu_bt.engine.status import FAILURE, IDLE, SUCCESS, Status


class Decorator(TreeNode):
    """A node around one child. When the child has ended, it is reset after the tick."""

    @property
    def role(self) -> Role:
        """Its role in displays: it is drawn together with its child."""
        return Role.AROUND

    @property
    def child(self) -> TreeNode:
        """The one child."""
        return self.kids[0]

    def execute(self) -> Status:
        """Tick, then reset a child that has ended, so that its conditions are evaluated again."""
        new = super().execute()
        child = self.kids[0]
        if child.state is SUCCESS or child.state is FAILURE:
            child.state = IDLE
        return new

    def pass_on(self, status: Status) -> Status:
        """Return the child's status as this node's, with the child's failure."""
        if status is FAILURE:
            return self.fail_with(self.failure_of(self.child))
        return status

"""The node that the tree file disables."""

from __future__ import annotations

from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.status import SKIPPED, Status


class Disabled(TreeNode):
    """Always SKIPPED, and never started; the nodes below it are not built."""

    def execute(self) -> Status:
        """SKIPPED; this does not count as a run."""
        status = super().execute()
        self.runs = 0
        return status

    def step(self) -> Status:
        """SKIPPED."""
        return SKIPPED

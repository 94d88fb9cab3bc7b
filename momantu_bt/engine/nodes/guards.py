"""Precondition, and the node that the tree file disables."""

from __future__ import annotations

from typing import Any

from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.nodes.scripts import Code
from momantu_bt.engine.ports import Inputs
from momantu_bt.engine.status import FAILURE, SKIPPED, Status
from momantu_bt.failure import FAILED


class Precondition(Decorator):
    """Asks `if` before the child starts; when it does not hold, the status that `else` names.

    Once the child has been ticked it is not asked again until the child has ended. A halt is no
    end: as in BehaviorTree.CPP, a child that was halted starts again unasked. `fail_if` and
    `skip_if` are asked at each start.
    """

    def __init__(self, *arguments: Any, inputs: Inputs, code: Code, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.inputs = inputs
        self.code = code
        self.admitted = False

    def step(self) -> Status:
        """Ask unless the child is under way, then tick it."""
        self.admitted = self.admitted or self.code.holds()
        if not self.admitted:
            instead = Status[self.inputs["else"]]
            if instead is FAILURE:
                return self.fail(FAILED, f"`{self.code.text}` does not hold")
            return instead
        status = self.child.execute()
        if status.completed:
            self.child.reset()
            self.admitted = False
        return self.pass_on(status)

    def renew(self) -> None:
        """The next start asks again."""
        self.admitted = False


class Disabled(TreeNode):
    """Always SKIPPED, and never started; what is below it in the file is not built."""

    def execute(self) -> Status:
        """SKIPPED, which is no run."""
        status = super().execute()
        self.runs = 0
        return status

    def step(self) -> Status:
        """SKIPPED."""
        return SKIPPED

"""AlwaysSuccess, AlwaysFailure, Fail, SetBlackboard, UnsetBlackboard."""

from __future__ import annotations

from typing import Any

from momantu_bt.engine.blackboard import Cell
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.ports import Inputs
from momantu_bt.engine.status import SUCCESS, Status
from momantu_bt.failure import FAILED
from momantu_bt.skill import MISSING


class AlwaysSuccess(TreeNode):
    """Succeeds at once."""

    def step(self) -> Status:
        """SUCCESS."""
        return SUCCESS


class AlwaysFailure(TreeNode):
    """Fails at once, with FAILED."""

    def step(self) -> Status:
        """FAILURE."""
        return self.fail(FAILED, "always fails")


class Fail(TreeNode):
    """Fails at once with the code and sentence that the tree gives."""

    def __init__(self, *arguments: Any, inputs: Inputs, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.inputs = inputs

    def step(self) -> Status:
        """FAILURE."""
        return self.fail(str(self.inputs["code"]), self.inputs["message"])


class SetBlackboard(TreeNode):
    """Writes a value to a key."""

    def __init__(self, *arguments: Any, inputs: Inputs, key: Cell, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.inputs = inputs
        self.key = key

    def step(self) -> Status:
        """Write it."""
        self.key.write(self.inputs["value"])
        return SUCCESS


class UnsetBlackboard(TreeNode):
    """Removes a key's value."""

    def __init__(self, *arguments: Any, key: Cell, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.key = key

    def step(self) -> Status:
        """Clear it."""
        self.key.write(MISSING)
        return SUCCESS

"""Switch2 to Switch6: the child of the case that equals a variable, else the last child.

The variable is asked on each tick; a child that is no longer meant is halted. The chosen child's
status is the node's. A variable without a value chooses the last child.
"""

from __future__ import annotations

import re
from enum import Enum
from typing import Any

from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.ports import Inputs
from momantu_bt.engine.status import FAILURE, RUNNING, Status
from momantu_bt.failure import INPUT_MISSING, Failure
from momantu_bt.tree.script.nodes import EPSILON

_NUMBER = re.compile(r"-?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")


class Switch(TreeNode):
    """Children: one for each case in order, then the one for everything else."""

    def __init__(self, *arguments: Any, inputs: Inputs, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.inputs = inputs
        self.at: int | None = None

    def step(self) -> Status:
        """Choose, halt the child that is no longer meant, tick the chosen one."""
        chosen = self._chosen()
        if self.at is not None and self.at != chosen:
            self.kids[self.at].reset()
        child = self.kids[chosen]
        status = child.execute()
        self.at = chosen if status is RUNNING else None
        if status is RUNNING:
            return RUNNING
        if status is FAILURE:
            self.fail_with(self.failure_of(child))
        self.reset_children()
        return status

    def clear(self) -> None:
        """No child is chosen."""
        self.at = None

    def _chosen(self) -> int:
        default = len(self.kids) - 1
        try:
            variable = self.inputs["variable"]
        except Failure as failure:
            if failure.value.code == INPUT_MISSING:
                return default
            raise
        cases = (self.inputs[f"case_{number}"] for number in range(1, default + 1))
        return next((i for i, case in enumerate(cases) if is_case(variable, case)), default)


def is_case(value: Any, case: Any) -> bool:
    """Whether a value is the one that a case names: equal as it is, as text or as a number.

    A text that reads as a number is one; numbers are equal within `EPSILON`; `true` is no number.
    """
    value, case = (_bare(value), _bare(case))
    if type(value) is type(case) and value == case:
        return True
    left, right = _number(value), _number(case)
    return left is not None and right is not None and abs(left - right) <= EPSILON


def _bare(value: Any) -> Any:
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, bool):
        return "true" if value else "false"
    return value


def _number(value: Any) -> float | None:
    if isinstance(value, int | float):
        return float(value)
    if isinstance(value, str) and _NUMBER.fullmatch(value):
        return float(value)
    return None

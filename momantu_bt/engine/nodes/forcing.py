"""Inverter, ForceSuccess, ForceFailure, ElseFail: the child's end, changed.

| child returns   | Inverter | ForceSuccess | ForceFailure | ElseFail                |
|-----------------|----------|--------------|--------------|-------------------------|
| SUCCESS         | FAILURE  | SUCCESS      | FAILURE      | SUCCESS                 |
| FAILURE         | SUCCESS  | SUCCESS      | FAILURE      | FAILURE with its `code` |
| RUNNING SKIPPED | the same | the same     | the same     | the same                |
"""

from __future__ import annotations

from typing import Any

from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.ports import Inputs
from momantu_bt.engine.status import FAILURE, RUNNING, SUCCESS, Status
from momantu_bt.failure import FAILED


class _Changing(Decorator):
    """Ticks the child, and answers with what `end` makes of its end."""

    def step(self) -> Status:
        """Tick the child."""
        self.state = RUNNING
        status = self.child.execute()
        if not status.completed:
            return status
        self.child.reset()
        return self.end(status)

    def end(self, status: Status) -> Status:
        """The node's status after the child's SUCCESS or FAILURE."""
        raise NotImplementedError


class Inverter(_Changing):
    """Success becomes failure and failure success."""

    def end(self, status: Status) -> Status:
        """FAILURE for SUCCESS, and the other way round."""
        if status is FAILURE:
            return SUCCESS
        return self.fail(FAILED, f"{self.child.name} succeeded, which counts as failure here")


class ForceSuccess(_Changing):
    """Whatever the child's end: success."""

    def end(self, status: Status) -> Status:
        """SUCCESS."""
        return SUCCESS


class ForceFailure(_Changing):
    """Whatever the child's end: failure, the child's own where it has one."""

    def end(self, status: Status) -> Status:
        """FAILURE."""
        if status is FAILURE:
            return self.pass_on(FAILURE)
        return self.fail(FAILED, f"{self.child.name} succeeded, and the tree forces a failure")


class ElseFail(_Changing):
    """The child's failure becomes the cause of one with the code that the tree gives."""

    def __init__(self, *arguments: Any, inputs: Inputs, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.inputs = inputs

    def end(self, status: Status) -> Status:
        """A failure with the code; SUCCESS as it is."""
        if status is not FAILURE:
            return status
        cause = self.failure_of(self.child)
        return self.fail(str(self.inputs["code"]), self.inputs["message"], cause)

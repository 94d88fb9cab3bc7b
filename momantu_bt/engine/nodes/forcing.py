"""Inverter, ForceSuccess, ForceFailure: the child's end, changed.

| child returns   | Inverter | ForceSuccess | ForceFailure |
|-----------------|----------|--------------|--------------|
| SUCCESS         | FAILURE  | SUCCESS      | FAILURE      |
| FAILURE         | SUCCESS  | SUCCESS      | FAILURE      |
| RUNNING SKIPPED | the same | the same     | the same     |
"""

from __future__ import annotations

from momantu_bt.engine.node import Decorator
from momantu_bt.engine.status import FAILURE, RUNNING, SUCCESS, Status
from momantu_bt.failure import FAILED


class Inverter(Decorator):
    """Success becomes failure and failure success."""

    def step(self) -> Status:
        """Tick the child and turn its end round."""
        self.state = RUNNING
        status = self.child.execute()
        if not status.completed:
            return status
        self.child.reset()
        if status is FAILURE:
            return SUCCESS
        return self.fail(FAILED, f"{self.child.name} succeeded, which counts as failure here")


class ForceSuccess(Decorator):
    """Whatever the child's end: success."""

    def step(self) -> Status:
        """Tick the child."""
        self.state = RUNNING
        status = self.child.execute()
        if not status.completed:
            return status
        self.child.reset()
        return SUCCESS


class ForceFailure(Decorator):
    """Whatever the child's end: failure, the child's own where it has one."""

    def step(self) -> Status:
        """Tick the child."""
        self.state = RUNNING
        status = self.child.execute()
        if not status.completed:
            return status
        self.child.reset()
        if status is FAILURE:
            return self.pass_on(FAILURE)
        return self.fail(FAILED, f"{self.child.name} succeeded, and the tree forces a failure")

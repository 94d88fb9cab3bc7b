"""RecoveryNode: Nav2's way of recovering, which knows no codes.

| child  | returns          | RecoveryNode                                              |
|--------|------------------|-----------------------------------------------------------|
| first  | SUCCESS, SKIPPED | the same                                                  |
| first  | FAILURE          | the second child, in the same tick; FAILURE after retries |
| second | SUCCESS          | the first child again, in the same tick                   |
| second | FAILURE, SKIPPED | FAILURE                                                   |
| either | RUNNING          | RUNNING                                                   |
"""

from __future__ import annotations

from typing import Any

from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.ports import Inputs
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SUCCESS, Status
from momantu_bt.engine.tries import with_root_cause, with_tries
from momantu_bt.failure import FailureValue


class RecoveryNode(TreeNode):
    """The first child; when it fails the second one, then the first one again.

    It succeeds with the first child. It fails when that has failed once more than
    `number_of_retries`, or when the second child fails or is skipped.
    """

    def __init__(self, *arguments: Any, inputs: Inputs, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.inputs = inputs
        self.retries = 0
        self.recovering: FailureValue | None = None

    def step(self) -> Status:
        """Tick the child whose turn it is, and the other one after its end."""
        self.state = RUNNING
        while True:
            failure = self.recovering
            ending = self._worked() if failure is None else self._recovered(failure)
            if ending is not None:
                return ending

    @property
    def note(self) -> str:
        """Which try it is, and what it recovers from."""
        doing = f", recovering from {self.recovering.code}" if self.recovering else ""
        return f"try {self.retries + 1}{doing}"

    def clear(self) -> None:
        """No tries yet."""
        self.retries = 0
        self.recovering = None

    def _worked(self) -> Status | None:
        work = self.kids[0]
        status = work.execute()
        if status is RUNNING:
            return RUNNING
        if status is not FAILURE:
            self._finish()
            self.state = IDLE  # skipped, it is as if it had never started
            return status
        failure, most = self.failure_of(work), self.inputs["number_of_retries"]
        if self.retries >= most:
            tries = self.retries + 1
            self._finish()
            return self.fail_with(with_tries(self, failure, tries, most + 1))
        work.reset()
        self.recovering = failure
        self.show(RUNNING)
        return None

    def _recovered(self, failure: FailureValue) -> Status | None:
        recovery = self.kids[1]
        status = recovery.execute()
        if status is RUNNING:
            return RUNNING
        if status is SUCCESS:
            recovery.reset()
            self.retries += 1
            self.recovering = None
            self.show(RUNNING)
            return None
        if status is FAILURE:
            failure = with_root_cause(self.failure_of(recovery), failure)
        self._finish()
        return self.fail_with(failure)

    def _finish(self) -> None:
        self.reset_children()
        self.clear()

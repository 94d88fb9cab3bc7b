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

from momantu_bt.engine.causes import with_root_cause, with_tries
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SUCCESS, Status
from momantu_bt.failure import FailureValue
from momantu_bt.nodes.counting import count_text, written_count
from momantu_bt.tree.catalogue.flow import After, Walk, again, as_child
from momantu_bt.tree.catalogue.known import Known, meet
from momantu_bt.tree.catalogue.spec import Dialect, control, input_port
from momantu_bt.tree.model import Node


def _recovering(walk: Walk, node: Node, before: Known) -> After:
    """The second child runs after a failure of the first."""
    work = as_child(walk, node, before)
    ends = [walk(child, work.failure) for child in node.children[1:]]
    failures = [meet(end.failure, end.skipped) for end in ends]
    return After(work.success, meet(work.failure, *failures), work.skipped)


class RecoveryNode(TreeNode):
    """Runs the first child; when it fails, runs the second child, then the first one again.

    It succeeds when the first child succeeds. It fails when the first child has failed
    `number_of_retries` + 1 times, or when the second child fails or is skipped.
    """

    spec = control(
        "RecoveryNode",
        "recovery_node",
        "Runs the first child; when it fails, runs the second one, then the first one again.",
        input_port(
            "number_of_retries", int, "how often the first child runs once more", 1, least=0
        ),
        dialect=Dialect.NAV2,
        children=(2, 2),
        retries=True,
        flow=again(_recovering),
        roles=lambda node: ["", "to recover"],
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.retries = 0
        self.recovering: FailureValue | None = None

    def step(self) -> Status:
        """Tick the current child; when it has ended, tick the other one if needed."""
        self.state = RUNNING
        while True:
            failure = self.recovering
            ending = self._worked() if failure is None else self._recovered(failure)
            if ending is not None:
                return ending

    @property
    def note(self) -> str:
        """The number of the try, and the failure from which it recovers."""
        doing = f", recovering from {self.recovering.code}" if self.recovering else ""
        retries = written_count(self.model, "number_of_retries", default=1)
        most = None if retries is None else retries + 1
        return count_text("try", self.retries + 1, most) + doing

    def clear(self) -> None:
        """Forget the tries."""
        self.retries = 0
        self.recovering = None

    def _worked(self) -> Status | None:
        work = self.kids[0]
        status = work.execute()
        if status is RUNNING:
            return RUNNING
        if status is not FAILURE:
            self._finish()
            self.state = IDLE  # a skipped node counts as not started
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

"""PipelineSequence, NonblockingSequence, PersistentSequence: Nav2's sequences.

| child returns | PipelineSequence                             | NonblockingSequence       |
|---------------|----------------------------------------------|---------------------------|
| RUNNING       | RUNNING; but the next child where it was     | the next child; RUNNING   |
|               | passed before                                | at the end                |
| SUCCESS       | the next child; at the end SUCCESS           | the same                  |
| FAILURE       | FAILURE, all are halted                      | the same                  |
| SKIPPED       | the next child; SKIPPED when all were        | the same                  |

Both tick from the first child on each time, also those that have ended.
"""

from __future__ import annotations

from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.failure import WRONG_TYPE
from momantu_bt.nodes.parallel import all_together
from momantu_bt.tree.catalogue.flow import again, anywhere, in_turn
from momantu_bt.tree.catalogue.spec import Dialect, control, input_port


class PipelineSequence(TreeNode):
    """Children before `reached` have been passed once: it no longer waits for them."""

    spec = control(
        "PipelineSequence",
        "pipeline_sequence",
        "A sequence that goes on ticking the children it has passed, and waits for them no more.",
        dialect=Dialect.NAV2,
        concurrent=True,
        flow=again(in_turn),
    )

    reached = 0

    def step(self) -> Status:
        """Tick from the first on."""
        skipped = 0
        for index, child in enumerate(self.kids):
            status = child.execute()
            if status is FAILURE:
                return self._failed(child)
            if status is RUNNING and index >= self.reached:
                self.reached = index
                return RUNNING
            skipped += status is SKIPPED
        self.reset_children()
        self.reached = 0
        return SKIPPED if skipped == len(self.kids) else SUCCESS

    def clear(self) -> None:
        """No child has been passed."""
        self.reached = 0

    def _failed(self, child: TreeNode) -> Status:
        failure = self.failure_of(child)
        self.reset_children()
        self.reached = 0
        return self.fail_with(failure)


class NonblockingSequence(TreeNode):
    """SUCCESS when all children succeed in the same tick."""

    spec = control(
        "NonblockingSequence",
        "nonblocking_sequence",
        "Ticks all children on each tick until all succeed in one.",
        dialect=Dialect.NAV2,
        concurrent=True,
        flow=again(all_together),
    )

    def step(self) -> Status:
        """Tick all of them."""
        found: list[Status] = []
        for child in self.kids:
            status = child.execute()
            if status is FAILURE:
                failure = self.failure_of(child)
                self.reset_children()
                return self.fail_with(failure)
            found.append(status)
        if RUNNING in found:
            return RUNNING
        self.reset_children()
        return SUCCESS if SUCCESS in found else SKIPPED


class PersistentSequence(TreeNode):
    """A sequence whose place is a key of the blackboard: it outlasts halts, and may be set.

    A failure sends it back to the first child, and so does its end.
    """

    spec = control(
        "PersistentSequence",
        "persistent_sequence",
        "A sequence that keeps its place on the blackboard.",
        input_port("current_child_idx", int, "the key that holds the place, from 0"),
        dialect=Dialect.NAV2,
        keys=("current_child_idx",),
        flow=again(anywhere),
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.cell = parts.key("current_child_idx")

    def step(self) -> Status:
        """Tick children from the place on."""
        at: int = self.inputs["current_child_idx"]
        if at < 0:
            return self.fail(WRONG_TYPE, f"${self.cell.name} is {at}; places count from 0")
        self.state = RUNNING
        while at < len(self.kids):
            child = self.kids[at]
            status = child.execute()
            if status is RUNNING:
                return RUNNING
            if status is FAILURE:
                return self._failed(child)
            at += 1
            self.cell.write(at)
        self.reset_children()
        self.cell.write(0)
        return SUCCESS

    def _failed(self, child: TreeNode) -> Status:
        failure = self.failure_of(child)
        self.reset_children()
        self.cell.write(0)
        return self.fail_with(failure)

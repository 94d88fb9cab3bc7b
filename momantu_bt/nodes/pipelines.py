"""PipelineSequence, NonblockingSequence, PersistentSequence: Nav2's sequences.

| child returns | PipelineSequence                             | NonblockingSequence       |
|---------------|----------------------------------------------|---------------------------|
| RUNNING       | RUNNING; but the next child where it was     | the next child; RUNNING   |
|               | passed before                                | at the end                |
| SUCCESS       | the next child; at the end SUCCESS           | the same                  |
| FAILURE       | FAILURE, all are halted                      | the same                  |
| SKIPPED       | the next child; SKIPPED when all were        | the same                  |

Both tick the children from the first one on each tick, including those that have ended.
"""

from __future__ import annotations

from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.failure import WRONG_TYPE
from momantu_bt.nodes.parallel import all_together
from momantu_bt.tree.catalogue.flow import again, anywhere, in_turn
from momantu_bt.tree.catalogue.spec import Dialect, control, input_port


class PipelineSequence(TreeNode):
    """A sequence that keeps ticking the children before the current one, without waiting for them.

    reached: index of the current child.
    """

    spec = control(
        "PipelineSequence",
        "pipeline_sequence",
        "A sequence that keeps ticking earlier children, without waiting for them again.",
        dialect=Dialect.NAV2,
        concurrent=True,
        flow=again(in_turn),
    )

    reached = 0

    def step(self) -> Status:
        """Tick the children from the first one on."""
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
        """Start with the first child again."""
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
        "Ticks all children on each tick until all succeed in the same tick.",
        dialect=Dialect.NAV2,
        concurrent=True,
        flow=again(all_together),
    )

    def step(self) -> Status:
        """Tick all children."""
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
    """A sequence that keeps the index of its current child in a key of the blackboard.

    The index stays when the node is halted, and other nodes may set it. It goes back to 0 when the
    node ends, with success or failure.
    """

    spec = control(
        "PersistentSequence",
        "persistent_sequence",
        "A sequence that keeps the index of its current child on the blackboard.",
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
        """Tick the child at the index, and those after it."""
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

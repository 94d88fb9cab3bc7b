"""ReactiveSequence, ReactiveFallback: each tick begins with the first child again.

| child returns | ReactiveSequence                  | ReactiveFallback                  |
|---------------|-----------------------------------|-----------------------------------|
| RUNNING       | all others are halted, RUNNING    | the same                          |
| SUCCESS       | the next child; at the end SUCCESS | SUCCESS, all others are halted   |
| FAILURE       | FAILURE, all others are halted    | the next child; at the end FAILURE |
| SKIPPED       | the next child; SKIPPED when all were | the same                      |
"""

from __future__ import annotations

from momantu_bt.engine.causes import with_beside
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.failure import FailureValue
from momantu_bt.tree.catalogue.flow import again, in_turn, until_success
from momantu_bt.tree.catalogue.spec import control


class ReactiveSequence(TreeNode):
    """A sequence that ticks earlier children again; if one of them fails, later ones are halted."""

    spec = control(
        "ReactiveSequence",
        "reactive_sequence",
        "A sequence that ticks earlier children again on each tick.",
        flow=again(in_turn),
    )

    def step(self) -> Status:
        """Tick children from the first on."""
        self.state = RUNNING
        all_skipped = True
        for child in self.kids:
            status = child.execute()
            if status is SKIPPED:
                child.reset()
                continue
            all_skipped = False
            if status is RUNNING:
                reset_others(self, child)
                return RUNNING
            if status is FAILURE:
                failure = self.failure_of(child)
                self.reset_children()
                return self.fail_with(failure)
        self.reset_children()
        return SKIPPED if all_skipped else SUCCESS


class ReactiveFallback(TreeNode):
    """A fallback that ticks earlier children again on each tick."""

    spec = control(
        "ReactiveFallback",
        "reactive_fallback",
        "A fallback that ticks earlier children again on each tick.",
        flow=again(until_success),
    )

    def step(self) -> Status:
        """Tick children from the first on."""
        self.state = RUNNING
        failures: list[FailureValue] = []
        for child in self.kids:
            status = child.execute()
            if status is SKIPPED:
                child.reset()
            elif status is RUNNING:
                reset_others(self, child)
                return RUNNING
            elif status is SUCCESS:
                self.reset_children()
                return SUCCESS
            else:
                failures.append(self.failure_of(child))
        self.reset_children()
        return self.fail_with(with_beside(failures)) if failures else SKIPPED


def reset_others(node: TreeNode, kept: TreeNode) -> None:
    """Reset every child but one."""
    for child in node.kids:
        if child is not kept and child.state is not IDLE:
            child.reset()

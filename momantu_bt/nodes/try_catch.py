"""TryCatch: runs children in turn; when one fails, the last child cleans up and the node fails.

| where | child returns | TryCatch                                        |
|-------|---------------|-------------------------------------------------|
| try   | RUNNING       | RUNNING                                         |
| try   | SUCCESS       | the next child; at the end SUCCESS              |
| try   | FAILURE       | the last child, in the same tick                |
| try   | SKIPPED       | the next child; SKIPPED when all of these were  |
| catch | RUNNING       | RUNNING                                         |
| catch | any other     | FAILURE, with the failure that led here         |

With `catch_on_halt`, a halt before any failure ticks the last child once; if it returns RUNNING, it
is halted too.
"""

from __future__ import annotations

from dataclasses import replace

from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.failure import HALTED, Failure, FailureValue
from momantu_bt.tree.catalogue.flow import After, Walk
from momantu_bt.tree.catalogue.known import NEVER, Known, meet
from momantu_bt.tree.catalogue.spec import control, input_port
from momantu_bt.tree.model import Literal, Node


def _cleaned_up(walk: Walk, node: Node, before: Known) -> After:
    if not node.children:
        return After(before, before)
    *tried, cleaner = node.children
    known, failures, all_skipped = before, [NEVER], True
    for child in tried:
        after = walk(child, known)
        known = after.passed
        failures.append(after.failure)
        all_skipped = all_skipped and after.skipped.reached
    failed = meet(*failures)
    if node.ports.get("catch_on_halt", Literal(False)) != Literal(False):
        failed = meet(failed, before.lacking(walk.removed(*tried)))
    cleaned = walk(cleaner, failed)
    ends = meet(cleaned.success, cleaned.failure, cleaned.skipped)
    return After(known, ends, known if all_skipped else NEVER)


class TryCatch(TreeNode):
    """Tries the children `kids[:-1]`; `kids[-1]` cleans up after a failure."""

    spec = control(
        "TryCatch",
        "try_catch",
        "Runs all but the last child in turn; when one fails, runs the last one, and then fails.",
        input_port("catch_on_halt", bool, "the last child also cleans up after a halt", False),
        children=(2, None),
        flow=_cleaned_up,
        roles=lambda node: [*[""] * (len(node.children) - 1), "in any failure"],
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.at = self.skipped = 0
        self.caught: FailureValue | None = None

    def step(self) -> Status:
        """Continue with the children or with the clean-up."""
        if self.state is IDLE:
            self.skipped = 0
            self.caught = None
        self.state = RUNNING
        tried = self.kids[:-1]
        while self.caught is None and self.at < len(tried):
            child = tried[self.at]
            status = child.execute()
            if status is RUNNING:
                return RUNNING
            if status is FAILURE:
                self.caught = self.failure_of(child)
                self.reset_children()
                self.at = 0
            else:
                self.at += 1
                self.skipped += status is SKIPPED
        if self.caught is not None:
            return self._clean_up(self.caught)
        all_skipped = self.skipped == len(tried)
        self.reset_children()
        self.at = self.skipped = 0
        return SKIPPED if all_skipped else SUCCESS

    def halt(self) -> None:
        """Halt; clean up first if `catch_on_halt` is set and nothing has failed yet."""
        try:
            if self.state is RUNNING and self.caught is None and self._cleans_up_halted():
                for child in self.kids[:-1]:
                    child.reset()
                self.caught = self.own(FailureValue(HALTED, "was halted"))
                self.kids[-1].execute()
        finally:
            super().halt()

    def clear(self) -> None:
        """Forget all progress."""
        self.at = self.skipped = 0
        self.caught = None

    @property
    def note(self) -> str:
        """The failure after which it cleans up."""
        return "" if self.caught is None else f"{self.caught.code}: cleaning up"

    def _cleans_up_halted(self) -> bool:
        try:
            wanted: bool = self.inputs["catch_on_halt"]
        except Failure as failure:
            self.context.remark(f"{self.where}: while it was halted: {failure.value}")
            return False
        return wanted

    def _clean_up(self, caught: FailureValue) -> Status:
        cleaner = self.kids[-1]
        status = cleaner.execute()
        if status is RUNNING:
            return RUNNING
        if status is FAILURE:
            caught = replace(caught, beside=(*caught.beside, self.failure_of(cleaner)))
        self.reset_children()
        self.at, self.caught = 0, None
        return self.fail_with(caught)

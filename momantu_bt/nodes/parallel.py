"""Parallel, ParallelAll: tick all children on each tick; one that has ended is not ticked again.

Parallel ends as soon as `success_count` children have succeeded, `failure_count` have failed, or
success has become impossible; children that still run are halted. ParallelAll waits until all
children have ended, then fails when `max_failures` or more have failed. A count of -1 means all
children, -2 all but one. The node is SKIPPED when all children are skipped. If all children must
succeed, a skipped child is not counted.
"""

from __future__ import annotations

from momantu_bt.engine.causes import with_beside
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.failure import FAILED, FailureValue
from momantu_bt.tree.catalogue.flow import After, Walk, again
from momantu_bt.tree.catalogue.known import NEVER, Known, both
from momantu_bt.tree.catalogue.spec import control, input_port
from momantu_bt.tree.model import Literal, Node


def _together(walk: Walk, node: Node, before: Known) -> After:
    """After a parallel node it is not known which children have written their outputs."""
    ends = [walk(child, before) for child in node.children]
    skipped = before if all(end.skipped.reached for end in ends) else NEVER
    return After(before, before, skipped)


def all_together(walk: Walk, node: Node, before: Known) -> After:
    """As `_together`; if all children must succeed, the outputs of all of them are known."""
    if node.ports.get("success_count", Literal(-1)) != Literal(-1):
        return _together(walk, node, before)
    ends = [walk(child, before) for child in node.children]
    skipped = before if all(end.skipped.reached for end in ends) else NEVER
    passed = [end.passed for end in ends if end.passed.reached]
    return After(both(before, *passed).lacking(walk.removed(node)), before, skipped)


class _Parallel(TreeNode):
    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.clear()

    def clear(self) -> None:
        """Forget which children have ended."""
        self.ended: set[int] = set()
        self.succeeded = 0
        self.failures_seen: list[FailureValue] = []

    def _tick_child(self, index: int) -> bool:
        """Tick a child unless it has ended; return whether it was skipped."""
        if index in self.ended:
            return False
        child = self.kids[index]
        status = child.execute()
        if status is SUCCESS:
            self.succeeded += 1
            self.ended.add(index)
        elif status is FAILURE:
            self.failures_seen.append(self.failure_of(child))
            self.ended.add(index)
        return status is SKIPPED

    def _finish(self, failed: bool) -> Status:
        failures = self.failures_seen
        self.clear()
        self.reset_children()
        if not failed:
            return SUCCESS
        if not failures:
            return self.fail(FAILED, "too few of its children can still succeed")
        return self.fail_with(with_beside(failures))

    def _count(self, name: str) -> int:
        """A threshold as a number of children."""
        count: int = self.inputs[name]
        return count if count >= 0 else max(len(self.kids) + count + 1, 0)


class Parallel(_Parallel):
    """Ends as soon as its result is decided."""

    spec = control(
        "Parallel",
        "parallel",
        "Children together; ends when enough of them have succeeded or failed.",
        input_port("success_count", int, "how many successes end it well; -1 is all", -1),
        input_port("failure_count", int, "how many failures end it badly; -1 is all", 1),
        concurrent=True,
        flow=again(all_together),
    )

    def step(self) -> Status:
        """Tick each child that has not ended; after each, check whether the result is decided."""
        most, need = len(self.kids), self._count("success_count")
        limit, all_needed = self._count("failure_count"), self.inputs["success_count"] < 0
        if need > most or limit > most:
            return self.fail(
                FAILED,
                f"has {most} children, but waits for {need} successes or {limit} failures",
            )
        self.state = RUNNING
        skipped = 0
        for index in range(most):
            skipped += self._tick_child(index)
            failed = len(self.failures_seen)
            if self.succeeded + (skipped if all_needed else 0) >= need:
                return self._finish(failed=False)
            if most - failed < need or failed == limit:
                return self._finish(failed=True)
        return SKIPPED if skipped == most else RUNNING


class ParallelAll(_Parallel):
    """Ends when all have ended."""

    spec = control(
        "ParallelAll",
        "parallel_all",
        "Children together until all have ended.",
        input_port("max_failures", int, "how many failures make it fail; -1 is all", 1),
        concurrent=True,
        flow=again(_together),
    )

    def step(self) -> Status:
        """Tick each child that has not ended."""
        most, limit = len(self.kids), self._count("max_failures")
        if limit > most:
            return self.fail(FAILED, f"has {most} children, but waits for {limit} failures")
        self.state = RUNNING
        skipped = sum([self._tick_child(index) for index in range(most)])
        if skipped == most:
            return SKIPPED
        if skipped + len(self.ended) < most:
            return RUNNING
        return self._finish(failed=len(self.failures_seen) >= limit)

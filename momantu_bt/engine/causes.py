"""Failures on their way up: the number of tries, and the causes behind or beside one."""

from __future__ import annotations

from dataclasses import replace

from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.status import RUNNING
from momantu_bt.failure import HALTED, FailureValue


def with_tries(node: TreeNode, failure: FailureValue, tries: int, most: int) -> FailureValue:
    """The same failure, saying that it came `tries` times of at most `most` (-1: any number).

    A failure that counts tries already keeps its count; `node` then stands before it.
    """
    if failure.most_tries == 0:
        return replace(failure, tries=tries, most_tries=most)
    return replace(through(node, failure), tries=tries, most_tries=most)


def through(node: TreeNode, failure: FailureValue) -> FailureValue:
    """The failure as it leaves a node that has a name of its own, with the inner one as cause."""
    return node.own(FailureValue(failure.code, failure.message, failure.data, cause=failure))


def with_root_cause(failure: FailureValue, cause: FailureValue) -> FailureValue:
    """The failure with one more cause behind its last one."""
    if failure.cause is None:
        return replace(failure, cause=cause)
    return replace(failure, cause=with_root_cause(failure.cause, cause))


def with_beside(failures: list[FailureValue]) -> FailureValue:
    """The last of some failures, with the earlier ones beside it."""
    *earlier, last = failures
    return replace(last, beside=(*earlier, *last.beside)) if earlier else last


def running_as_cause(node: TreeNode, seconds: float) -> FailureValue:
    """The deepest running node below a node, as the cause of the failure that ends it."""
    running = [n for n in (node, *node.below) if n.shown is RUNNING]
    deepest = max(running, key=lambda n: n.depth, default=node)
    doing = f" ({deepest.note})" if deepest.note else ""
    return deepest.own(FailureValue(HALTED, f"was running{doing} after {seconds:.1f} s"))

"""Functions that add to failures on their way up the tree: tries, causes, failures of siblings."""

from __future__ import annotations

from dataclasses import replace

from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.status import RUNNING
from momantu_bt.failure import HALTED, FailureValue


def with_tries(node: TreeNode, failure: FailureValue, tries: int, most: int) -> FailureValue:
    """The failure with the number of tries and their limit `most` (-1: no limit).

    If the failure counts tries already, it becomes the cause of a new failure of `node`.
    """
    if failure.most_tries == 0:
        return replace(failure, tries=tries, most_tries=most)
    return replace(through(node, failure), tries=tries, most_tries=most)


def through(node: TreeNode, failure: FailureValue) -> FailureValue:
    """The failure of a node with a name of its own; the inner failure becomes its cause."""
    return node.own(FailureValue(failure.code, failure.message, failure.data, cause=failure))


def with_root_cause(failure: FailureValue, cause: FailureValue) -> FailureValue:
    """The failure with a further cause at the end of its chain of causes."""
    if failure.cause is None:
        return replace(failure, cause=cause)
    return replace(failure, cause=with_root_cause(failure.cause, cause))


def with_beside(failures: list[FailureValue]) -> FailureValue:
    """The last of some failures; the earlier ones are in its `beside`."""
    *earlier, last = failures
    return replace(last, beside=(*earlier, *last.beside)) if earlier else last


def running_as_cause(node: TreeNode, seconds: float) -> FailureValue:
    """A failure that names the deepest running node; the cause for a failure that stops it."""
    running = [n for n in (node, *node.below) if n.shown is RUNNING]
    deepest = max(running, key=lambda n: n.depth, default=node)
    doing = f" ({deepest.note})" if deepest.note else ""
    return deepest.own(FailureValue(HALTED, f"was running{doing} after {seconds:.1f} s"))

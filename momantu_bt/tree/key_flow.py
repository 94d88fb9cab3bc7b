"""What is known after each built-in node with children, from what its children leave known.

`walk(child, before)` gives what is known after the child's success and after its failure.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeAlias

from momantu_bt.failure import FailureValue
from momantu_bt.tree.keys import NEVER, Key, Known, meet
from momantu_bt.tree.model import Literal, Node

After: TypeAlias = tuple[Known, Known]
"""What is known after success, and after failure."""
Walk: TypeAlias = Callable[[Node, Known], After]
Flow: TypeAlias = Callable[[Walk, Node, Known], After]

FAILURE_KEY = "failure"
"""What a handler reads as `$failure`."""


def _in_turn(walk: Walk, node: Node, before: Known) -> After:
    failures = [NEVER]
    for child in node.children:
        before, failed = walk(child, before)
        failures.append(failed)
    return before, meet(*failures)


def _until_success(walk: Walk, node: Node, before: Known) -> After:
    successes = [NEVER]
    for child in node.children:
        succeeded, before = walk(child, before)
        successes.append(succeeded)
    return meet(*successes), before


def _any_first(walk: Walk, node: Node, before: Known) -> After:
    results = [walk(child, before) for child in node.children]
    return meet(NEVER, *(success for success, _ in results)), before


def _together(walk: Walk, node: Node, before: Known) -> After:
    results = [walk(child, before) for child in node.children]
    all_succeed = node.ports.get("success_count", Literal(-1)) == Literal(-1)
    if node.type != "Parallel" or not all_succeed:
        return before, before
    success = before
    for succeeded, _ in results:
        for name, key in (succeeded.keys or {}).items():
            success = success.having(name, key)
    return success, before


def _branches(walk: Walk, node: Node, before: Known) -> After:
    if not node.children:
        return before, before
    yes, no = walk(node.children[0], before)
    results = [
        walk(child, known) for child, known in zip(node.children[1:3], (yes, no), strict=False)
    ]
    failures = [failure for _, failure in results]
    if len(results) < 2:
        failures.append(no)
    return meet(NEVER, *(success for success, _ in results)), meet(*failures)


def _recover(walk: Walk, node: Node, before: Known) -> After:
    success, failure = _child(walk, node, before)
    handled = [
        walk(handler.node, failure.having(FAILURE_KEY, Key(FailureValue, handler.place)))
        for handler in node.handlers
        if handler.node is not None
    ]
    failed = meet(failure, *(failure for _, failure in handled))
    if node.type == "Handle":
        return meet(success, *(success for success, _ in handled)), failed
    return success, failed


def _child(walk: Walk, node: Node, before: Known) -> After:
    return walk(node.children[0], before) if node.children else (before, before)


def _inverter(walk: Walk, node: Node, before: Known) -> After:
    success, failure = _child(walk, node, before)
    return failure, success


def _force_success(walk: Walk, node: Node, before: Known) -> After:
    return meet(*_child(walk, node, before)), NEVER


def _force_failure(walk: Walk, node: Node, before: Known) -> After:
    return NEVER, meet(*_child(walk, node, before))


def _until_failure(walk: Walk, node: Node, before: Known) -> After:
    return NEVER, _child(walk, node, before)[1]


def _perhaps(walk: Walk, node: Node, before: Known) -> After:
    """The child may not run at all, and the node succeeds or fails all the same."""
    success, failure = _child(walk, node, before)
    return meet(success, before), meet(failure, before)


def _around(walk: Walk, node: Node, before: Known) -> After:
    """The child may be ended early, and the node fails then."""
    success, failure = _child(walk, node, before)
    return success, meet(failure, before)


FLOWS: Mapping[str, Flow] = {
    "Sequence": _in_turn,
    "AsyncSequence": _in_turn,
    "SequenceWithMemory": _in_turn,
    "ReactiveSequence": _in_turn,
    "Fallback": _until_success,
    "AsyncFallback": _until_success,
    "ReactiveFallback": _until_success,
    "RoundRobin": _any_first,
    "Parallel": _together,
    "ParallelAll": _together,
    "IfThenElse": _branches,
    "WhileDoElse": _branches,
    "Recover": _recover,
    "Handle": _recover,
    "Inverter": _inverter,
    "ForceSuccess": _force_success,
    "ForceFailure": _force_failure,
    "KeepRunningUntilFailure": _until_failure,
    "Precondition": _perhaps,
    "ForEach": _perhaps,
    "RetryUntilSuccessful": _around,
    "Repeat": _around,
    "Timeout": _around,
    "Delay": _around,
    "RunOnce": _around,
}
"""By canonical type."""

"""How knowledge of keys flows through each built-in node with children.

`walk(child, before)` gives what is known after each end that the child can have.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

from momantu_bt.failure import FailureValue
from momantu_bt.tree.check.keys.known import NEVER, Key, Known, both, meet
from momantu_bt.tree.model import Literal, Node


class After(NamedTuple):
    """What is known after success, after failure, and where the node was skipped."""

    success: Known
    failure: Known
    skipped: Known = NEVER

    @property
    def passed(self) -> Known:
        """After an end that a sequence goes on from."""
        return meet(self.success, self.skipped)


@dataclass(frozen=True, slots=True)
class Walk:
    """What a flow asks of the nodes below it.

    into: what is known after each end that a node can have. removed: keys of the tree's board that
    nodes, or something below them, may take away. rewritten: keys that they write, as far as it is
    known what.
    """

    into: Callable[[Node, Known], After]
    removed: Callable[..., set[str]]
    rewritten: Callable[[Node], Iterable[tuple[str, Key]]]

    def __call__(self, node: Node, before: Known) -> After:
        """What is known after each end that the node can have."""
        return self.into(node, before)


Flow: TypeAlias = Callable[[Walk, Node, Known], After]

FAILURE_KEY = "failure"
"""What a handler reads as `$failure`."""


def _in_turn(walk: Walk, node: Node, before: Known) -> After:
    known, failures, all_skipped = before, [NEVER], True
    for child in node.children:
        after = walk(child, known)
        known = after.passed
        failures.append(after.failure)
        all_skipped = all_skipped and after.skipped.reached
    return After(known, meet(*failures), known if all_skipped else NEVER)


def _until_success(walk: Walk, node: Node, before: Known) -> After:
    known, successes, all_skipped = before, [NEVER], True
    for child in node.children:
        after = walk(child, known)
        known = meet(after.failure, after.skipped)
        successes.append(after.success)
        all_skipped = all_skipped and after.skipped.reached
    return After(meet(*successes), known, known if all_skipped else NEVER)


def _again(flow: Flow) -> Flow:
    """Children may be asked again after a later one has run, which took keys away or wrote them."""

    def known_each_time(walk: Walk, node: Node, before: Known) -> After:
        known = before.lacking(walk.removed(node)).rewritten(walk.rewritten(node))
        return flow(walk, node, known)

    return known_each_time


def _any_first(walk: Walk, node: Node, before: Known) -> After:
    ends = [walk(child, before) for child in node.children]
    skipped = before if any(end.skipped.reached for end in ends) else NEVER
    return After(meet(NEVER, *(end.success for end in ends)), before, skipped)


def _together(walk: Walk, node: Node, before: Known) -> After:
    ends = [walk(child, before) for child in node.children]
    skipped = before if all(end.skipped.reached for end in ends) else NEVER
    all_succeed = node.ports.get("success_count", Literal(-1)) == Literal(-1)
    if node.type == "ParallelAll" or not all_succeed:
        return After(before, before, skipped)
    passed = [end.passed for end in ends if end.passed.reached]
    return After(both(before, *passed).lacking(walk.removed(node)), before, skipped)


def _anywhere(walk: Walk, node: Node, before: Known) -> After:
    """It may begin with any child."""
    for child in node.children:
        walk(child, before)
    return After(before, before)


def _cases(walk: Walk, node: Node, before: Known) -> After:
    ends = [walk(child, before) for child in node.children]
    return After(
        meet(NEVER, *(end.success for end in ends)),
        meet(before, *(end.failure for end in ends)),
        meet(NEVER, *(end.skipped for end in ends)),
    )


def _try_catch(walk: Walk, node: Node, before: Known) -> After:
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


def _retreat(walk: Walk, node: Node, before: Known) -> After:
    """`recovery_node`: the second child runs after a failure of the first."""
    work = _child(walk, node, before)
    ends = [walk(child, work.failure) for child in node.children[1:]]
    failures = [meet(end.failure, end.skipped) for end in ends]
    return After(work.success, meet(work.failure, *failures), work.skipped)


def _unless_skipped(walk: Walk, node: Node, before: Known) -> After:
    end = _child(walk, node, before)
    return After(end.success, end.failure, meet(end.skipped, before))


def _branches(walk: Walk, node: Node, before: Known) -> After:
    if not node.children:
        return After(before, before)
    asked = walk(node.children[0], before)
    starts = (asked.success, asked.failure)
    ends = [walk(c, known) for c, known in zip(node.children[1:3], starts, strict=False)]
    failures = [end.failure for end in ends]
    if len(ends) < 2:
        failures.append(asked.failure)
    skipped = meet(asked.skipped, *(end.skipped for end in ends))
    return After(meet(NEVER, *(end.success for end in ends)), meet(*failures), skipped)


def _recover(walk: Walk, node: Node, before: Known) -> After:
    tried = _child(walk, node, before)
    handled = [
        walk(handler.node, tried.failure.having(FAILURE_KEY, Key(FailureValue, handler.place)))
        for handler in node.handlers
        if handler.node is not None
    ]
    failed = meet(tried.failure, *(end.failure for end in handled))
    if node.type == "Recover":
        return After(tried.success, failed, tried.skipped)
    success = meet(tried.success, *(end.success for end in handled))
    return After(success, failed, meet(tried.skipped, *(end.skipped for end in handled)))


def _child(walk: Walk, node: Node, before: Known) -> After:
    return walk(node.children[0], before) if node.children else After(before, before)


def _inverter(walk: Walk, node: Node, before: Known) -> After:
    end = _child(walk, node, before)
    return After(end.failure, end.success, end.skipped)


def _force_success(walk: Walk, node: Node, before: Known) -> After:
    end = _child(walk, node, before)
    return After(meet(end.success, end.failure), NEVER, end.skipped)


def _force_failure(walk: Walk, node: Node, before: Known) -> After:
    end = _child(walk, node, before)
    return After(NEVER, meet(end.success, end.failure), end.skipped)


def _until_failure(walk: Walk, node: Node, before: Known) -> After:
    end = _child(walk, node, before)
    return After(NEVER, end.failure, end.skipped)


def _perhaps(walk: Walk, node: Node, before: Known) -> After:
    """The child may not run at all, and the node may end in any way all the same."""
    end = _child(walk, node, before)
    return After(meet(end.success, before), meet(end.failure, before), meet(end.skipped, before))


def _once(walk: Walk, node: Node, before: Known) -> After:
    """Later, the child is skipped and what it wrote is still there, or its end is repeated."""
    end = _child(walk, node, before)
    return After(end.success, meet(end.failure, before), before)


def _around(walk: Walk, node: Node, before: Known) -> After:
    """The child may be ended early, and the node fails then."""
    end = _child(walk, node, before)
    return After(end.success, meet(end.failure, before), end.skipped)


FLOWS: Mapping[str, Flow] = {
    "Sequence": _in_turn,
    "AsyncSequence": _in_turn,
    "SequenceWithMemory": _in_turn,
    "ReactiveSequence": _again(_in_turn),
    "Fallback": _until_success,
    "AsyncFallback": _until_success,
    "ReactiveFallback": _again(_until_success),
    "RoundRobin": _again(_any_first),
    "Parallel": _again(_together),
    "ParallelAll": _again(_together),
    "IfThenElse": _branches,
    "WhileDoElse": _again(_branches),
    "Recover": _again(_recover),
    "Handle": _recover,
    "Inverter": _inverter,
    "ForceSuccess": _force_success,
    "ForceFailure": _force_failure,
    "ElseFail": _child,
    "KeepRunningUntilFailure": _again(_until_failure),
    "Precondition": _perhaps,
    "ForEach": _again(_perhaps),
    "RetryUntilSuccessful": _again(_around),
    "Repeat": _again(_around),
    "Timeout": _again(_around),
    "Delay": _around,
    "RunOnce": _once,
    "Switch2": _again(_cases),
    "Switch3": _again(_cases),
    "Switch4": _again(_cases),
    "Switch5": _again(_cases),
    "Switch6": _again(_cases),
    "TryCatch": _try_catch,
    "LoopInt": _again(_perhaps),
    "LoopDouble": _again(_perhaps),
    "LoopString": _again(_perhaps),
    "LoopBool": _again(_perhaps),
    "SkipUnlessUpdated": _unless_skipped,
    "WaitValueUpdate": _child,
    "RecoveryNode": _again(_retreat),
    "PipelineSequence": _again(_in_turn),
    "NonblockingSequence": _again(_together),
    "PersistentSequence": _again(_anywhere),
    "RateController": _again(_around),
    "DistanceController": _again(_around),
    "SpeedController": _again(_around),
    "SingleTrigger": _around,
    "GoalUpdatedController": _again(_child),
    "GoalUpdater": _child,
    "PathLongerOnApproach": _perhaps,
}
"""By canonical type."""

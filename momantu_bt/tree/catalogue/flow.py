"""How knowledge about keys flows through a node with children.

A flow says it for one kind of node. `walk(child, before)` gives what is known after each end that
the child can have. The flows here are those that several kinds share.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeAlias

from momantu_bt.tree.catalogue.known import NEVER, Key, Known, meet
from momantu_bt.tree.model import Node


@dataclass(frozen=True, slots=True)
class After:
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
    """What a flow asks about the nodes below it, and of the checker.

    into: what is known after each end that a node can have. removed: keys of the tree's board that
    nodes, or something below them, may take away. rewritten: keys that they write, as far as it is
    known what. outputs: what is known when the outputs of a node have been written. script: what is
    known after the script at a port of a node.
    """

    into: Callable[[Node, Known], After]
    removed: Callable[..., set[str]]
    rewritten: Callable[[Node], Iterable[tuple[str, Key]]]
    outputs: Callable[[Node, Known], Known]
    script: Callable[[Node, str, Known], Known]

    def __call__(self, node: Node, before: Known) -> After:
        """What is known after each end that the node can have."""
        return self.into(node, before)


Flow: TypeAlias = Callable[[Walk, Node, Known], After]
"""`before` has what the node hands on to its children."""


def again(flow: Flow) -> Flow:
    """Children may be asked again after a later one has run, which took keys away or wrote them."""

    def known_each_time(walk: Walk, node: Node, before: Known) -> After:
        known = before.lacking(walk.removed(node)).rewritten(walk.rewritten(node))
        return flow(walk, node, known)

    return known_each_time


def in_turn(walk: Walk, node: Node, before: Known) -> After:
    """Each child after the success of the one before."""
    known, failures, all_skipped = before, [NEVER], True
    for child in node.children:
        after = walk(child, known)
        known = after.passed
        failures.append(after.failure)
        all_skipped = all_skipped and after.skipped.reached
    return After(known, meet(*failures), known if all_skipped else NEVER)


def until_success(walk: Walk, node: Node, before: Known) -> After:
    """Each child after the failure of the one before."""
    known, successes, all_skipped = before, [NEVER], True
    for child in node.children:
        after = walk(child, known)
        known = meet(after.failure, after.skipped)
        successes.append(after.success)
        all_skipped = all_skipped and after.skipped.reached
    return After(meet(*successes), known, known if all_skipped else NEVER)


def anywhere(walk: Walk, node: Node, before: Known) -> After:
    """It may begin with any child, and end after any: nothing new is sure."""
    for child in node.children:
        walk(child, before)
    return After(before, before)


def as_child(walk: Walk, node: Node, before: Known) -> After:
    """What is known after the first child."""
    return walk(node.children[0], before) if node.children else After(before, before)


def around(walk: Walk, node: Node, before: Known) -> After:
    """The child may be ended early, and the node fails then."""
    end = as_child(walk, node, before)
    return After(end.success, meet(end.failure, before), end.skipped)


def perhaps(walk: Walk, node: Node, before: Known) -> After:
    """The child may not run at all, and the node may end in any way all the same."""
    end = as_child(walk, node, before)
    return After(meet(end.success, before), meet(end.failure, before), meet(end.skipped, before))


def unsure(walk: Walk, node: Node, before: Known) -> After:
    """The flow of an unknown node: its children run in any order, any number of times, or never."""
    known = before.lacking(walk.removed(node)).rewritten(walk.rewritten(node))
    for child in node.children:
        walk(child, known)
    return After(known, known, known)


def as_written(walk: Walk, node: Node, before: Known) -> After:
    """Of a leaf: with success its outputs are written."""
    return After(walk.outputs(node, before), before)

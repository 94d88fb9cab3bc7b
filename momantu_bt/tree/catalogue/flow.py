"""Which keys surely have a value after a node, given those before it.

A flow is a function that computes this for one kind of node. It calls `walk(child, before)` for
what is known after each possible end of a child. The flows here are used by several kinds of nodes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeAlias

from momantu_bt.tree.catalogue.known import NEVER, Key, Known, meet
from momantu_bt.tree.model import Node


@dataclass(frozen=True, slots=True)
class After:
    """What is known after a node's success, after its failure, and when it was skipped."""

    success: Known
    failure: Known
    skipped: Known = NEVER

    @property
    def passed(self) -> Known:
        """What is known when a sequence continues after the node: success or skipped."""
        return meet(self.success, self.skipped)


@dataclass(frozen=True, slots=True)
class Walk:
    """What a flow can ask the checker about the nodes below it.

    into: what is known after each possible end of a node. removed: keys that nodes, or nodes below
    them, may remove. rewritten: keys that a node writes, with what is known about the values.
    outputs: what is known after a node has written its outputs. script: what is known after the
    script at a port of a node.
    """

    into: Callable[[Node, Known], After]
    removed: Callable[..., set[str]]
    rewritten: Callable[[Node], Iterable[tuple[str, Key]]]
    outputs: Callable[[Node, Known], Known]
    script: Callable[[Node, str, Known], Known]

    def __call__(self, node: Node, before: Known) -> After:
        """What is known after each possible end of the node."""
        return self.into(node, before)


Flow: TypeAlias = Callable[[Walk, Node, Known], After]
"""`before` has what the node hands on to its children."""


def again(flow: Flow) -> Flow:
    """A flow for nodes that run earlier children again, after later ones wrote or removed keys."""

    def known_each_time(walk: Walk, node: Node, before: Known) -> After:
        known = before.lacking(walk.removed(node)).rewritten(walk.rewritten(node))
        return flow(walk, node, known)

    return known_each_time


def in_turn(walk: Walk, node: Node, before: Known) -> After:
    """Each child runs after the success of the one before it."""
    known, failures, all_skipped = before, [NEVER], True
    for child in node.children:
        after = walk(child, known)
        known = after.passed
        failures.append(after.failure)
        all_skipped = all_skipped and after.skipped.reached
    return After(known, meet(*failures), known if all_skipped else NEVER)


def until_success(walk: Walk, node: Node, before: Known) -> After:
    """Each child runs after the failure of the one before it."""
    known, successes, all_skipped = before, [NEVER], True
    for child in node.children:
        after = walk(child, known)
        known = meet(after.failure, after.skipped)
        successes.append(after.success)
        all_skipped = all_skipped and after.skipped.reached
    return After(meet(*successes), known, known if all_skipped else NEVER)


def anywhere(walk: Walk, node: Node, before: Known) -> After:
    """The node may begin with any child and end after any: no new key is sure."""
    for child in node.children:
        walk(child, before)
    return After(before, before)


def as_child(walk: Walk, node: Node, before: Known) -> After:
    """What is known after the first child."""
    return walk(node.children[0], before) if node.children else After(before, before)


def around(walk: Walk, node: Node, before: Known) -> After:
    """The node may stop the child early; it fails then."""
    end = as_child(walk, node, before)
    return After(end.success, meet(end.failure, before), end.skipped)


def perhaps(walk: Walk, node: Node, before: Known) -> After:
    """The child may not run at all; the node may then still succeed or fail."""
    end = as_child(walk, node, before)
    return After(meet(end.success, before), meet(end.failure, before), meet(end.skipped, before))


def unsure(walk: Walk, node: Node, before: Known) -> After:
    """The flow of an unknown node: its children run in any order, any number of times, or never."""
    known = before.lacking(walk.removed(node)).rewritten(walk.rewritten(node))
    for child in node.children:
        walk(child, known)
    return After(known, known, known)


def as_written(walk: Walk, node: Node, before: Known) -> After:
    """The flow of a leaf: after success its outputs are written."""
    return After(walk.outputs(node, before), before)

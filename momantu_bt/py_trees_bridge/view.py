"""A running tree as py_trees sees it: for `py_trees.display`, visitors and `BehaviourTree`.

A view has no state of its own: it reads its node at each access. Ticking the view ticks the node,
and stopping the view resets the node.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from py_trees import common, composites, decorators
from py_trees.behaviour import Behaviour

from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.tree.catalogue import NODES

PY_TREES_STATUS: Mapping[Status, common.Status] = {
    IDLE: common.Status.INVALID,
    SKIPPED: common.Status.INVALID,
    RUNNING: common.Status.RUNNING,
    SUCCESS: common.Status.SUCCESS,
    FAILURE: common.Status.FAILURE,
}
"""py_trees has no IDLE and no SKIPPED; both become its INVALID."""


def view(root: TreeNode) -> Behaviour:
    """A py_trees behaviour for a node, and one for each node below it.

    `momantu_bt.engine.build.Built.root` is the root of a tree. Sequences, fallbacks, parallels and
    decorators have py_trees' classes of these names, so that displays draw them correctly.
    """
    return _kind(root)(root)


class NodeView(Behaviour):
    """One node. node: what it shows."""

    def __init__(self, node: TreeNode) -> None:
        self.node = node
        Behaviour.__init__(self, node.name)
        for kid in node.kids:
            child = view(kid)
            child.parent = self
            self.children.append(child)

    @property
    def status(self) -> common.Status:
        """The node's newest result."""
        return PY_TREES_STATUS[self.node.shown]

    @status.setter
    def status(self, value: common.Status) -> None:
        """Ignored: py_trees' constructor sets it; the node decides it."""

    @property
    def feedback_message(self) -> str:
        """The text beside its name: its note while it runs, or its failure."""
        if self.node.shown is FAILURE:
            return str(self.node.failure or "")
        return self.node.note if self.node.shown is RUNNING else ""

    @feedback_message.setter
    def feedback_message(self, value: str) -> None:
        """Ignored, like `status`."""

    def update(self) -> common.Status:
        """The node's status; py_trees asks for this method."""
        return self.status

    def tick(self) -> Iterator[Behaviour]:
        """Tick the node, then yield the views of all that were ticked, children first."""
        context = self.node.context
        context.begin_tick()
        self.node.execute()
        for each in self.iterate():
            if isinstance(each, NodeView) and each.node.ticked_at == context.tick:
                yield each

    def stop(self, new_status: common.Status = common.Status.INVALID) -> None:
        """Reset the node, which halts what runs."""
        self.node.reset()

    def tip(self) -> Behaviour | None:
        """The deepest node that decided the newest result; None before the first tick."""
        if self.status is common.Status.INVALID:
            return None
        deciding = [child for child in self.children if child.status is self.status]
        return (deciding[-1].tip() or self) if deciding else self


class SequenceView(NodeView, composites.Sequence):
    """Children in turn."""

    memory = True


class ReactiveSequenceView(NodeView, composites.Sequence):
    """Children in turn; each tick starts again with the first."""

    memory = False


class SelectorView(NodeView, composites.Selector):
    """Children until one succeeds."""

    memory = True


class ReactiveSelectorView(NodeView, composites.Selector):
    """Children until one succeeds; each tick starts again with the first."""

    memory = False


class ParallelView(NodeView, composites.Parallel):
    """Children side by side."""


class DecoratorView(NodeView, decorators.Decorator):
    """Around one child."""

    def __init__(self, node: TreeNode) -> None:
        super().__init__(node)
        self.decorated = self.children[0]


_KINDS: Mapping[str, type[NodeView]] = {
    "ReactiveSequence": ReactiveSequenceView,
    "Fallback": SelectorView,
    "AsyncFallback": SelectorView,
    "ReactiveFallback": ReactiveSelectorView,
}


def _kind(node: TreeNode) -> type[NodeView]:
    spec = NODES.get(node.model.type)
    if isinstance(node, Decorator):
        return DecoratorView
    if spec is None:
        return NodeView
    if spec.in_turn:
        return SequenceView
    return ParallelView if spec.concurrent else _KINDS.get(spec.type, NodeView)

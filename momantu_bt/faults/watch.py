"""Watch a running tree for the beginning of a phase."""

from __future__ import annotations

from collections.abc import Sequence

from momantu_bt.engine.context import RunContext
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.skills.session import CLOCK_SLACK
from momantu_bt.engine.status import RUNNING, SUCCESS
from momantu_bt.faults.phase import Phase
from momantu_bt.faults.phases import wears
from momantu_bt.tree.model import Document


class PhaseWatch:
    """Whether the phase has begun; called after each tick until it has.

    node: the one that made it begin; None for a phase that goes by the clock.
    """

    def __init__(self, phase: Phase, nodes: Sequence[TreeNode], document: Document) -> None:
        self.node: TreeNode | None = None
        self._phase = phase
        self._left = phase.count
        self._due: float | None = None if phase.names else phase.delay
        self._nodes = _matching(phase.names, nodes, document)
        self._noting = []
        if len(phase.names) > 1 and not phase.after:
            self._noting = _matching(phase.names[:-1], nodes, document)
        self._running: dict[int, int] = {}

    def begun(self, context: RunContext) -> bool:
        """Whether the phase has begun by this tick; once True, always True."""
        if self._due is None:
            self._count(context)
        return self._due is not None and context.now >= self._due - CLOCK_SLACK

    def _count(self, context: RunContext) -> None:
        came = self._succeeded(context) if self._phase.after else self._started()
        for node in came:
            self._left -= 1
            if self._left == 0:
                self.node = node
                self._due = context.now + self._phase.delay
                return

    def _started(self) -> list[TreeNode]:
        """Nodes that are newly RUNNING, or newly have the phase's last name as their note.

        A node that ended and started again within a tick counts again.
        """
        running: dict[int, int] = {}
        came = []
        noting = [node for node in self._noting if node.note == self._phase.names[-1]]
        for node in (*self._nodes, *noting):
            if node.state is RUNNING and node.index not in running:
                running[node.index] = node.runs
                if self._running.get(node.index) != node.runs:
                    came.append(node)
        self._running = running
        return came

    def _succeeded(self, context: RunContext) -> list[TreeNode]:
        """Nodes that ended in SUCCESS in this tick; of two equal ends the journal has only one."""
        ended = {change.node.index for change in context.changes if change.status is SUCCESS}
        return [
            node
            for node in self._nodes
            if node.index in ended or (node.ticked_at == context.tick and node.shown is SUCCESS)
        ]


def _matching(
    names: Sequence[str], nodes: Sequence[TreeNode], document: Document
) -> list[TreeNode]:
    """Nodes with the last name inside nodes with the other names, the outermost first."""
    if not names:
        return []
    *outer, last = names
    return [
        node
        for node in nodes
        if wears(node.model, last, document) and _is_inside(node, outer, document)
    ]


def _is_inside(node: TreeNode, outer: Sequence[str], document: Document) -> bool:
    left = list(outer)
    above = node.above
    while left and isinstance(above, TreeNode):
        if wears(above.model, left[-1], document):
            left.pop()
        above = above.above
    return not left

"""The tree as lines of text, for the terminal and for pictures."""

from __future__ import annotations

from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SUCCESS
from momantu_bt.world import TreeLine

_OPEN = (RUNNING, FAILURE)


def tree_lines(root: TreeNode) -> list[TreeLine]:
    """The root and, of each node that is running or has failed, what is below it.

    What has succeeded or has not begun is one line, so that the picture stays small.
    """
    lines: list[TreeLine] = []

    def visit(node: TreeNode, depth: int) -> None:
        shown = node.kids
        if not (node.model.written_as_modifier or _is_frame(node)):
            lines.append(TreeLine(depth, node_text(node), node.shown.value))
            depth += 1
        if node.shown in _OPEN or depth == 0:
            for child in shown:
                if child.shown is not IDLE or node.shown is RUNNING:
                    visit(child, depth)

    visit(root, 0)
    return lines


def _is_frame(node: TreeNode) -> bool:
    """A nameless sequence is how a list of steps is written: it needs no line of its own."""
    return node.model.type == "Sequence" and node.model.name is None and node.parent is not None


def node_text(node: TreeNode) -> str:
    """Name, what it is about, and the phase of a running skill."""
    phase = getattr(node, "phase", "")
    text = node.name
    if phase and node.shown is RUNNING:
        text += f": {phase}"
    if node.shown is FAILURE and node.failure is not None:
        text += f": {node.failure.code}"
    return text


def running_text(root: TreeNode) -> str:
    """What runs deepest: `navigate: follow`; or how the tree ended."""
    if root.shown is SUCCESS or root.shown is FAILURE:
        return root.shown.value
    running = [n for n in (root, *root.below) if n.shown is RUNNING]
    deepest = max(running, key=lambda n: n.depth, default=root)
    return node_text(deepest)

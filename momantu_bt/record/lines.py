"""The tree as lines of text, for the terminal and for pictures."""

from __future__ import annotations

from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.nodes.subtree import SubTree
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SUCCESS
from momantu_bt.world import TreeLine


def tree_lines(root: TreeNode) -> list[TreeLine]:
    """The root and, of each node that is running or has failed, what is below it.

    What has succeeded or has not begun is one line, so that the picture stays small. A tree
    shares the line of the node that runs it, a decorator the line of its child.
    """
    lines: list[TreeLine] = []

    def visit(node: TreeNode, depth: int) -> None:
        inner = node
        notes = [node.note]
        while _shares_line(inner):
            inner = inner.kids[0]
            notes.append(inner.note)
        lines.append(TreeLine(depth, _with_notes(node, inner, notes), node.shown.value))
        if node.shown is RUNNING or node.shown is FAILURE or depth == 0:
            for child in _below(inner):
                if child.shown is not IDLE or inner.shown is RUNNING:
                    visit(child, depth + 1)

    visit(root, 0)
    return lines


def _shares_line(node: TreeNode) -> bool:
    return isinstance(node, Decorator) and not isinstance(node, SubTree) and bool(node.kids)


def _below(node: TreeNode) -> tuple[TreeNode, ...]:
    """Children, without the nameless frames that lists of steps and subtrees are written in."""
    found: list[TreeNode] = []
    for child in node.kids:
        frame = child.model.name is None and child.model.type == "Sequence"
        if frame or (isinstance(node, SubTree) and child.model.type == "Sequence"):
            found.extend(_below(child))
        else:
            found.append(child)
    return tuple(found)


def _with_notes(outer: TreeNode, inner: TreeNode, notes: list[str]) -> str:
    words = inner.label
    if outer.shown is RUNNING:
        words = ", ".join([words, *filter(None, notes)])
    if outer.shown is FAILURE and outer.failure is not None:
        words += f": {outer.failure.code}"
    return words


def running_text(root: TreeNode) -> str:
    """What runs deepest: `navigate table_a, follow`; or how the tree ended."""
    if root.shown is SUCCESS or root.shown is FAILURE:
        return root.shown.value
    running = [n for n in (root, *root.below) if n.shown is RUNNING]
    deepest = max(running, key=lambda n: n.depth, default=root)
    return ", ".join(filter(None, (deepest.label, deepest.note)))

"""Write the tree as lines of text, for the terminal and for pictures, of a run or of its record."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Protocol

from momantu_bt.engine.role import Role
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SUCCESS, Status
from momantu_bt.failure import FailureValue
from momantu_bt.world import TreeLine


class Shown(Protocol):
    """A node as a person sees it: a `TreeNode`, or one of a record at some instant."""

    @property
    def label(self) -> str:
        """The node in one line."""
        ...

    @property
    def role(self) -> Role:
        """Its role for a reader."""
        ...

    @property
    def note(self) -> str:
        """The text beside it while it runs."""
        ...

    @property
    def shown(self) -> Status:
        """Its newest result."""
        ...

    @property
    def failure(self) -> FailureValue | None:
        """Why it failed last."""
        ...

    @property
    def depth(self) -> int:
        """Its depth in the tree."""
        ...

    @property
    def kids(self) -> Sequence[Shown]:
        """Its children."""
        ...


def tree_lines(root: Shown) -> list[TreeLine]:
    """The root, and what is below each node that is running or has failed.

    A node that has succeeded or has not begun takes one line, so that the picture stays small. A
    tree shares the line of the node that runs it. A decorator shares the line of its child.
    """
    lines: list[TreeLine] = []

    def visit(node: Shown, depth: int) -> None:
        inner = node
        notes = [_note(node)]
        while inner.role is Role.AROUND and inner.kids:
            inner = inner.kids[0]
            notes.append(_note(inner))
        words = ", ".join([inner.label, *filter(None, notes)])
        if node.shown is FAILURE and node.failure is not None:
            words += f": {node.failure.code}"
        lines.append(TreeLine(depth, words, node.shown.value))
        if node.shown is RUNNING or node.shown is FAILURE or depth == 0:
            for child in _below(inner):
                if child.shown is not IDLE or inner.shown is RUNNING:
                    visit(child, depth + 1)

    visit(root, 0)
    return lines


def is_frame(role: Role, above: Role) -> bool:
    """Whether a node only holds a list of steps, or all of a subtree.

    above: the role of its parent.
    """
    return role is Role.STEPS or (role is Role.NAMED_STEPS and above is Role.TREE)


def _below(node: Shown) -> tuple[Shown, ...]:
    """Children, without frames."""
    found: list[Shown] = []
    for child in node.kids:
        if is_frame(child.role, node.role):
            found.extend(_below(child))
        else:
            found.append(child)
    return tuple(found)


def _note(node: Shown) -> str:
    """Its current note; a note from before its end is dropped."""
    return node.note if node.shown is RUNNING else ""


def running_text(root: Shown) -> str:
    """The deepest running node: `navigate table_a, follow`; or how the tree ended."""
    if root.shown is SUCCESS or root.shown is FAILURE:
        return root.shown.value
    running = (node for node in _all(root) if node.shown is RUNNING)
    deepest = max(running, key=lambda node: node.depth, default=root)
    return ", ".join(filter(None, (deepest.label, _note(deepest))))


def _all(root: Shown) -> Iterator[Shown]:
    stack = [root]
    while stack:
        node = stack.pop()
        yield node
        stack.extend(reversed(node.kids))

"""Write the tree as lines of text, for the terminal and for pictures, of a run or of its record."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Protocol

from momantu_bt.engine.role import Role
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SUCCESS, Status
from momantu_bt.failure import FailureValue
from momantu_bt.world import TreeLine

_WIDEST = 60
"""The most characters of the steps of a list that is not opened."""


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
    def shown_children(self) -> Sequence[tuple[str, bool]]:
        """The prefixes of its children and handlers; see `printing.plan`."""
        ...

    @property
    def around(self) -> str:
        """Its words if it is shown on its child's line; see `printing.around`."""
        ...

    @property
    def kids(self) -> Sequence[Shown]:
        """Its children."""
        ...


def tree_lines(root: Shown) -> list[TreeLine]:
    """The root, and what is below each node that is running or has failed.

    The structure is that of `momantu-bt show`: inner sequences, the role of each child, handlers
    with their codes, and decorators in words on their child's line. A node that has succeeded or
    has not begun takes one line, so that the picture stays small. A subtree shares the line of the
    node that runs it.
    """
    lines: list[TreeLine] = []

    def visit(node: Shown, depth: int, prefix: str) -> None:
        inner, words = _line(node)
        opened = node.shown is RUNNING or node.shown is FAILURE or depth == 0
        if not opened and inner.role is Role.STEPS:
            words = _steps(inner)
        lines.append(TreeLine(depth, prefix + words, node.shown.value))
        if opened:
            for before, child in _below(inner):
                if child is None and inner.shown is RUNNING:
                    lines.append(TreeLine(depth + 1, f"{before}try again", IDLE.value))
                elif child is not None and (child.shown is not IDLE or inner.shown is RUNNING):
                    visit(child, depth + 1, before)

    visit(root, 0, "")
    return lines


def _line(node: Shown) -> tuple[Shown, str]:
    """The node inside all decorators, and its words with those of the decorators."""
    inner, notes, around = node, [_note(node)], []
    while inner.around and len(inner.kids) == 1:
        around.append(inner.around)
        inner = inner.kids[0]
        notes.append(_note(inner))
    words = inner.label
    if around:
        words += f"  ({', '.join(reversed(around))})"
    words = ", ".join([words, *filter(None, notes)])
    if node.shown is FAILURE and node.failure is not None:
        words += f": {node.failure.code}"
    return inner, words


def _steps(node: Shown) -> str:
    """What a list of steps that is not opened would do."""
    words = ", then ".join(_line(child)[0].label for child in node.kids) or node.label
    return words if len(words) <= _WIDEST else f"{words[: _WIDEST - 1]}…"


def is_frame(role: Role, above: Role) -> bool:
    """Whether a node is only the list of all steps of a subtree, whose line it shares.

    above: the role of its parent.
    """
    return above is Role.TREE and role in (Role.STEPS, Role.NAMED_STEPS)


def _below(node: Shown) -> list[tuple[str, Shown | None]]:
    """Children with their prefixes; None for a handler that tries again. No frames."""
    kids: list[Shown] = []
    for child in node.kids:
        kids.extend(child.kids if is_frame(child.role, node.role) else (child,))
    rest = iter(kids)
    found: list[tuple[str, Shown | None]] = []
    for prefix, is_node in node.shown_children:
        found.append((prefix, next(rest, None) if is_node else None))
    return [*found, *(("", child) for child in rest)]


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

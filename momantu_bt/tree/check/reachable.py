"""Warnings of nodes that no run can reach."""

from __future__ import annotations

from collections.abc import Mapping

from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.model import Node


def report_unreachable(context: Context, root: Node, reached: Mapping[int, bool]) -> None:
    """Warn of each node that is never reached although its parent is; once among its siblings.

    reached: by the identity of a node, whether anything leads to it. Nodes that are missing were
    not looked at.
    """
    for node in root.walk():
        if not reached.get(id(node), False):
            continue
        before = None
        for child in node.children:
            if not reached.get(id(child), True) and not child.disabled:
                _report(context, node, child, before)
                break
            before = before if child.disabled else child


def _report(context: Context, parent: Node, node: Node, before: Node | None) -> None:
    message = f"{_said(context, node)} is never reached"
    hint = ""
    if before is not None:
        where = f" (line {before.place.line})" if before.place.line != node.place.line else ""
        ended = f"{_said(context, before)}{where}"
        hint = f"{ended} never ends so that {_said(context, parent)} goes on"
    context.problems.warning("unreachable", node.place, message, hint)


def _said(context: Context, node: Node) -> str:
    if node.name is not None:
        return node.name
    signature = context.signature(node)
    return node.target or node.type if signature is None else signature.said

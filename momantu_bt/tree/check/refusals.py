"""Warnings of catch-alls that also handle a person's no."""

from __future__ import annotations

from collections.abc import Mapping

from momantu_bt.failure import DECLINED
from momantu_bt.formats.places import within
from momantu_bt.tree.catalogue import SUBTREE
from momantu_bt.tree.catalogue.codes import Codes
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.language import ANY
from momantu_bt.tree.model import Node

_ONLY_LAST = ("Fallback", "AsyncFallback", "ReactiveFallback")
"""Nodes that fail with the failure of their last child."""


def check_refusals(
    context: Context, root: Node, of_node: Mapping[int, Codes], refusing: set[str]
) -> None:
    """Warn of each `any` that handles DECLINED, in one tree.

    of_node: the codes of each node. refusing: the trees that may fail with DECLINED; this adds
    nothing to it.
    """
    for node in root.walk():
        named = {code.split(".")[-1] for handler in node.handlers for code in handler.codes}
        if ANY not in named or DECLINED in named or not node.children:
            continue
        if not refuses(node.children[0], of_node, refusing):
            continue
        handler = next(handler for handler in node.handlers if ANY in handler.codes)
        place = within(handler.place, ANY, context.document.source)
        message = f"`{ANY}` also handles {DECLINED}: the person said no"
        hint = f"write a handler for {DECLINED}, or `{DECLINED} | {ANY}` if this is meant"
        context.problems.warning("swallowed-no", place, message, hint)


def refuses(node: Node, of_node: Mapping[int, Codes], refusing: set[str]) -> bool:
    """Whether a node may fail because a person said no."""
    if DECLINED not in of_node[id(node)]:
        return False
    if node.type == SUBTREE:
        return node.target in refusing
    below = [child for child in node.children if not child.disabled]
    if node.type in _ONLY_LAST:
        below = below[-1:]
    below += [handler.node for handler in node.handlers if handler.node is not None]
    return not below or any(refuses(each, of_node, refusing) for each in below)

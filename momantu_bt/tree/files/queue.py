"""The queue of nodes to read, each with its place in the tree."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from momantu_bt.tree.model import Handler, Node, Tree

Put: TypeAlias = Callable[[Node], None]


def into_tree(tree: Tree) -> Put:
    """Make the node the tree's root."""

    def put(node: Node) -> None:
        tree.root = node

    return put


def into_handler(handler: Handler) -> Put:
    """Make the node the one that the handler runs."""

    def put(node: Node) -> None:
        handler.node = node

    return put

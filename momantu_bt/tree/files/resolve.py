"""Resolving the names of trees, once all trees of a document are known."""

from __future__ import annotations

from momantu_bt.tree.catalogue import SUBTREE
from momantu_bt.tree.model import Document


def resolve(document: Document) -> None:
    """Resolve the nodes that run a tree. All trees must be known.

    A `<SubTree>` whose tree stands elsewhere keeps its target; the checker reports it.
    """
    trees = document.trees
    for tree in trees.values():
        for node in tree.root.walk():
            if node.type in trees and node.type != SUBTREE:
                node.type, node.target = SUBTREE, node.type

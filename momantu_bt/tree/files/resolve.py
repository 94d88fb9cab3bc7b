"""Resolving the names of trees, once all trees of a document are known."""

from __future__ import annotations

from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import Place
from momantu_bt.tree.catalogue import SUBTREE
from momantu_bt.tree.model import BROKEN, Document
from momantu_bt.tree.problems import Problems


def resolve(document: Document, problems: Problems) -> None:
    """Resolve the nodes that run a tree, and report names of no tree. All trees must be known."""
    trees = document.trees
    for tree in trees.values():
        for node in tree.root.walk():
            if node.type == SUBTREE and node.target not in trees:
                place: Place = node.condition_places.get("ID", node.place)
                hint = valid_names(node.target or "", trees, "trees")
                message = f"no tree is called {node.target!r}"
                problems.error("unknown-tree", place, message, hint)
                node.type, node.target = BROKEN, None
            elif node.type in trees and node.type != SUBTREE:
                node.type, node.target = SUBTREE, node.type

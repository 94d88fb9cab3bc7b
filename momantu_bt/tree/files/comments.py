"""Comments that would belong to something else after a document is written and read again."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TypeAlias

from momantu_bt.formats.text import Beside
from momantu_bt.tree.model import Document, Node, Tree

_Slots: TypeAlias = "tuple[tuple[str, ...], ...]"
_LINE_ENDS = re.compile("[\x85\u2028\u2029]")
"""What YAML takes for the end of a line, and so of a comment, and XML does not."""


def set_odd_comments_apart(document: Document) -> None:
    """Set `comments_apart` where comments have characters that YAML's comments cannot have."""
    document.comments_apart = _is_odd(_of_document(document))
    for tree in document.trees.values():
        tree.comments_apart = tree.comments_apart or _is_odd(_of_tree(tree))
        for node in tree.nodes():
            node.comments_apart = node.comments_apart or _is_odd(_of_node(node))


def _is_odd(slots: _Slots) -> bool:
    return any(_LINE_ENDS.search(text) for texts in slots for text in texts)


def set_comments_apart(document: Document, again: Document) -> bool:
    """Set `comments_apart` where a document read again has other comments.

    Both have the same trees and nodes. Returns whether anything was set that was not.
    """
    changed = False
    if _of_document(document) != _of_document(again) and not document.comments_apart:
        document.comments_apart = changed = True
    for name, tree in document.trees.items():
        other = again.trees.get(name)
        if other is None or other is tree:
            continue
        if _of_tree(tree) != _of_tree(other) and not tree.comments_apart:
            tree.comments_apart = changed = True
        for node, twin in zip(tree.nodes(), other.nodes(), strict=False):
            if _of_node(node) != _of_node(twin) and not node.comments_apart:
                node.comments_apart = changed = True
    return changed


def _slots(comments: Sequence[str]) -> _Slots:
    """The comments before something, and those beside it."""
    return (
        tuple(text for text in comments if not isinstance(text, Beside)),
        tuple(str(text) for text in comments if isinstance(text, Beside)),
    )


def _of_node(node: Node) -> _Slots:
    return (*_slots(node.comments), tuple(map(str, node.end_comments)))


def _of_tree(tree: Tree) -> _Slots:
    return (*_slots(tree.comments), tuple(map(str, tree.end_comments)))


def _of_document(document: Document) -> _Slots:
    models = [
        slot
        for model in document.models
        for each in (model.comments, *(port.comments for port in model.ports))
        for slot in _slots(each)
    ]
    ends = (document.header_comments, document.comments)
    return (*ends, *_slots(document.models_comments), *models)

"""The tag of a node in XML: explicit (`<Action ID="Go"/>`) or the node's type (`<Go/>`)."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from momantu_bt.tree.catalogue import EXPLICIT, NODES, SUBTREE, Kind, is_ours
from momantu_bt.tree.catalogue.nodes import said_type
from momantu_bt.tree.files.xml.attributes import is_name
from momantu_bt.tree.files.xml.nodes import ONCE
from momantu_bt.tree.files.xml.ports import PREFIX
from momantu_bt.tree.model import BROKEN, Document, Node


@dataclass(frozen=True, slots=True)
class Tags:
    """The tags of a document's nodes.

    explicit: whether they are usually explicit. kinds: of the nodes that have a model in the file,
    by name. trees: names of trees, which are no tags.
    """

    explicit: bool
    kinds: Mapping[str, str]
    trees: Collection[str]

    @classmethod
    def of(cls, document: Document) -> Tags:
        """The tags of a document."""
        kinds = {model.name: model.kind for model in document.models if model.kind != SUBTREE}
        return cls(document.explicit, kinds, document.trees)

    def usual(self, node: Node) -> str | None:
        """The explicit tag that a node usually has; "" if its type is the tag; None for SubTree."""
        if node.type in (SUBTREE, BROKEN):
            return None
        if not self.explicit and is_name(node.type) and not self.is_taken(node.type):
            return ""
        return self._kind(node)

    def is_taken(self, name: str) -> bool:
        """Whether a tag of this name means something other than the node of this type."""
        return name in EXPLICIT or name in ONCE or name in self.trees

    def written(self, node: Node) -> tuple[str, str | None]:
        """A node's tag, and its ID if the tag is explicit."""
        if node.type == BROKEN:
            return node.tag or "", None
        if node.type == SUBTREE:
            return SUBTREE, None
        tag = self.usual(node) if node.tag is None else node.tag
        name = PREFIX + node.type if is_ours(node.type) else said_type(node.type)
        if name != node.type and not is_ours(node.type):
            tag = tag or self._kind(node)
        return (tag, name) if tag else (name, None)

    def _kind(self, node: Node) -> str:
        spec = NODES.get(node.type)
        if spec is not None and spec.kind is Kind.LEAF:
            return "Condition" if spec.condition else "Action"
        if spec is not None:
            return spec.kind.value.capitalize()
        by_children = {0: "Action", 1: "Decorator"}
        return self.kinds.get(node.type) or by_children.get(len(node.children), "Control")


def settle_tags(document: Document) -> None:
    """Find out which tags are usual in a document, and leave only the others at their nodes.

    All its nodes say how their tag is written.
    """
    nodes = [
        node
        for tree in document.trees.values()
        if tree.place.file == document.file
        for node in tree.nodes()
        if node.type not in (SUBTREE, BROKEN)
    ]
    explicit = sum(1 for node in nodes if node.tag)
    document.explicit = explicit > len(nodes) - explicit
    tags = Tags.of(document)
    for node in nodes:
        if node.tag == tags.usual(node):
            node.tag = None

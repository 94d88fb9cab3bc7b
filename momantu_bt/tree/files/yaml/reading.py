"""The state of reading a YAML file: what is known, and what waits to be read."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection
from dataclasses import dataclass, field

from momantu_bt.formats.places import Place
from momantu_bt.formats.yaml.values import Items, Raw
from momantu_bt.tree.catalogue import NODES, SPELLED
from momantu_bt.tree.files.queue import Put
from momantu_bt.tree.files.xml.nodes import NodeReader as AttributeReader
from momantu_bt.tree.model import BROKEN, Node
from momantu_bt.tree.problems import Problems


@dataclass(slots=True)
class Reading:
    """Takes problems, and values at node positions.

    trees, skills: names of the document's trees and of the installed skills. attributes: reads
    attributes in XML's spelling. explicit: whether the file's nodes usually have explicit tags in
    XML.
    """

    trees: Collection[str]
    skills: Collection[str]
    problems: Problems
    attributes: AttributeReader
    explicit: bool = False
    waiting: deque[tuple[Raw, Put]] = field(default_factory=deque)

    def is_known(self, name: str) -> bool:
        """Whether a node of the language or a tree has this name."""
        return name in SPELLED or name in self.trees

    def later(self, raw: Raw, put: Put) -> None:
        """Read a node when its turn comes."""
        self.waiting.append((raw, put))

    def children(self, node: Node, raw: Items) -> None:
        """Read each item of a list as a child of the node."""
        for item in raw.items:
            self.waiting.append((item, node.children.append))

    def error(self, code: str, place: Place, message: str, hint: str = "") -> None:
        """Report a problem."""
        self.problems.error(code, place, message, hint)

    def broken(self, code: str, place: Place, message: str, hint: str = "") -> Node:
        """Report a problem that belongs to no node."""
        self.error(code, place, message, hint)
        return Node(BROKEN, place)

    def misfit(self, node: Node, value: Raw, message: str, hint: str = "") -> None:
        """Report a value of the wrong form. The node is not read further."""
        self.error("wrong-value", value.place, message, hint)
        node.type = BROKEN


def said(node: Node) -> str:
    """The node as the file calls it."""
    spec = NODES.get(node.type)
    return node.target or (spec.yaml[0] if spec is not None else node.type)

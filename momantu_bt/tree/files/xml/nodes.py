"""XML elements at node positions, as nodes of the model. Reads with a queue, not by recursion.

Which attributes a node has comes from its NodeSpec, from its skill, or from the tree it runs.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field

from momantu_bt.formats.names import nearest, valid_names
from momantu_bt.formats.xml.elements import Element
from momantu_bt.plugins import PluginError
from momantu_bt.skill import Port
from momantu_bt.tree.catalogue import (
    EXPLICIT,
    NODES,
    SUBTREE,
    Dialect,
    NodeSpec,
    is_ours,
    of_dialect,
)
from momantu_bt.tree.catalogue.nodes import theirs
from momantu_bt.tree.files.queue import Put, into_handler
from momantu_bt.tree.files.syntax import OURS
from momantu_bt.tree.files.xml.attributes import AttributeWriter
from momantu_bt.tree.files.xml.ports import CATCH, PREFIX, PortReader
from momantu_bt.tree.language import ANY, handler_codes
from momantu_bt.tree.model import BROKEN, Handler, Node, PortDeclaration
from momantu_bt.tree.problems import Problems
from momantu_bt.tree.registry import Registry

PORT = "Port"
"""Our element inside a node for a port whose name cannot be an attribute. It is not a node."""
ONCE = {"SubTreePlus": SUBTREE, "Subtree": SUBTREE, "SequenceStar": "SequenceWithMemory"}
"""Tags of BehaviorTree.CPP 3, and what they are called now."""


@dataclass(slots=True)
class NodeReader:
    """Reads node positions. trees: the ports of each known tree, by name."""

    trees: Mapping[str, Mapping[str, PortDeclaration]]
    registry: Registry
    problems: Problems
    _waiting: deque[tuple[Element, Put]] = field(default_factory=deque)
    _skills: dict[str, Mapping[str, Port] | None] = field(default_factory=dict)
    _writer: AttributeWriter = field(init=False)

    def __post_init__(self) -> None:
        self._writer = AttributeWriter(self.trees, self.registry)

    def read(self, element: Element, put: Put) -> None:
        """Read one node and all below it, and give it to `put`; BROKEN if it cannot be read."""
        self._waiting.append((element, put))
        while self._waiting:
            following, its_put = self._waiting.popleft()
            its_put(self._node(following))

    def _node(self, element: Element) -> Node:
        node = Node(BROKEN, element.place)
        node.comments, node.end_comments = element.comments, element.end_comments
        node.text, node.tail = element.text.strip(), element.tail.strip()
        self._refuse_text(element)
        reader = self.named(node, element)
        if node.type == BROKEN:
            for child in element.children:
                self._waiting.append((child, node.children.append))
            return node
        ports = [e for e in element.children if e.space == OURS and e.name == PORT]
        for each in ports:
            self._port_apart(reader, each)
        element.children = [each for each in element.children if each not in ports]
        self._inside(node, element, NODES.get(node.type))
        return node

    def named(self, node: Node, element: Element) -> PortReader:
        """Give a node what the tag and the attributes of its element say."""
        kept = {each.said: each.value for each in element.attributes if each.space != OURS}
        type_ = self._type(element)
        if type_ is None:
            node.tag, node.attributes = element.said, kept
            return PortReader(node, element, self.problems)
        node.type = type_
        if type_ == SUBTREE:
            self._target(node, element)
        elif element.name in EXPLICIT and not element.space:
            node.tag = element.name
            kept.pop("ID")
        else:
            node.tag = ""
        reader = self.ports(node, element)
        if node.type == BROKEN:
            node.tag, node.attributes = element.said, kept
        else:
            self._writer.keep(node, kept)
        return reader

    def ports(self, node: Node, element: Element) -> PortReader:
        """Read the attributes of a node whose type is known."""
        reader = PortReader(node, element, self.problems)
        spec = NODES.get(node.type)
        if spec is not None:
            reader.of_spec(spec)
        elif node.type == SUBTREE:
            reader.of_tree(self.trees.get(node.target or "", {}))
        elif node.type != BROKEN:
            reader.of_skill(self._ports_of(node.type))
        return reader

    def _port_apart(self, reader: PortReader, element: Element) -> None:
        name = element.get("name")
        if name is None or reader.spec is not None:
            message = f"<momantu:{PORT}> is for a port that no attribute can be named after"
            hint = f'write <momantu:{PORT} name="a b">value</momantu:{PORT}> in a node of your own'
            self.problems.error("unknown-port", element.place, message, hint)
            return
        reader.apart(name.value, element)

    def _refuse_text(self, element: Element) -> None:
        if element.text_place is not None:
            message = f"text inside <{element.said}> means nothing"
            hint = "what a node takes stands in its attributes"
            with self.problems.keeping():
                self.problems.error("not-a-node", element.text_place, message, hint)

    # what it is

    def _type(self, element: Element) -> str | None:
        """The canonical type; None if a problem was reported."""
        with self.problems.keeping():
            return self._type_of(element)

    def _type_of(self, element: Element) -> str | None:
        if element.space == OURS:
            return self._own_type(element)
        if element.space:
            message = f"<{element.name}> of the namespace {element.space!r} is not a node"
            self.problems.error("unknown-node", element.place, message)
            return None
        name = element.name
        if name in EXPLICIT:
            return self._explicit_type(element)
        if is_ours(name):
            return self._unknown(element, f"did you mean momantu:{name}?")
        if name in ONCE and name not in self.registry.skills:
            return self._unknown(element, f"did you mean {ONCE[name]}?")
        if name in self.trees and name not in self.registry.skills:
            return self._unknown(element, f'a tree is run by <SubTree ID="{name}"/>')
        return name

    def _unknown(self, element: Element, hint: str) -> str | None:
        message = f"no node is called {element.said!r}"
        self.problems.error("unknown-node", element.place, message, hint)
        return None

    def _own_type(self, element: Element) -> str | None:
        if is_ours(element.name):
            return element.name
        if element.name in NODES:
            return self._unknown(element, f"did you mean {element.name}?")
        known = of_dialect(Dialect.OURS)
        near = nearest(element.name, known)
        hint = f"did you mean momantu:{near}?" if near else ""
        return self._unknown(element, hint or valid_names(element.name, known, "nodes of ours"))

    def _explicit_type(self, element: Element) -> str | None:
        identity = element.get("ID")
        if identity is not None and identity.value:
            name = identity.value.removeprefix(PREFIX)
            ours = is_ours(name) and name != identity.value
            return name if ours else theirs(identity.value)
        message = f"<{element.name}> does not say which node it is"
        hint = f'write <{element.name} ID="name" …/>'
        self.problems.error("not-a-node", element.place, message, hint)
        return None

    def _target(self, node: Node, element: Element) -> None:
        identity = element.get("ID")
        if identity is None or not identity.value:
            message, hint = "<SubTree> does not say which tree", 'write <SubTree ID="Name" …/>'
            with self.problems.keeping():
                self.problems.error("not-a-node", element.place, message, hint)
            node.type = BROKEN
        else:
            node.target = identity.value
            node.condition_places["ID"] = identity.place

    def _ports_of(self, skill: str) -> Mapping[str, Port] | None:
        """A skill's ports; None if it is not installed."""
        if skill not in self._skills:
            try:
                self._skills[skill] = self.registry.skills[skill].ports
            except (KeyError, PluginError):
                self._skills[skill] = None
        return self._skills[skill]

    # what is inside it

    def _inside(self, node: Node, element: Element, spec: NodeSpec | None) -> None:
        inside = element.children
        catches = [each for each in inside if _is_handler(each)]
        if spec is not None and spec.handlers:
            inside = [each for each in inside if not _is_handler(each)]
            for each in catches:
                self._handler(node, each, spec)
            if not catches:
                message = f"<{element.said}> without a <momantu:{CATCH}>"
                hint = f'write <momantu:{CATCH} codes="A | B">…</momantu:{CATCH}>'
                self.problems.error("missing-child", element.place, message, hint)
        elif catches:
            message = f"<momantu:{CATCH}> stands in <momantu:Recover> or <momantu:Handle>"
            self.problems.error("not-a-node", catches[0].place, message)
            inside = [each for each in inside if not _is_handler(each)]
        self._count(node, element, len(inside), spec)
        for child in inside:
            self._waiting.append((child, node.children.append))

    def _count(self, node: Node, element: Element, count: int, spec: NodeSpec | None) -> None:
        """Read children whose positions have a meaning. The checker counts the others."""
        if spec is None or not spec.positions or spec.positions == ("child",):
            return
        if count < spec.children[0]:
            missing = spec.positions[count] if count < len(spec.positions) else "another"
            message = f"<{element.said}> has {count or 'no'} children; `{missing}` is missing"
            with self.problems.keeping():
                self.problems.error("missing-child", element.place, message)

    def _handler(self, node: Node, element: Element, spec: NodeSpec) -> None:
        self._refuse_text(element)
        codes = element.get("codes")
        for each in element.attributes:
            if each is not codes and each.name != "ID":
                message = f"<momantu:{CATCH}> has no attribute {each.name!r}"
                hint = valid_names(each.name, ["codes"], "attributes")
                self.problems.error("unknown-key", each.name_place, message, hint)
        if codes is None:
            message, hint = f"<momantu:{CATCH}> without codes", f'write codes="A | B" or "{ANY}"'
            self.problems.error("bad-code", element.place, message, hint)
            return
        found = handler_codes(codes.value, codes.place, self.problems)
        handler = Handler(found, None, codes.place, comments=element.comments)
        node.handlers.append(handler)
        if len(element.children) > 1:
            message = f"<momantu:{CATCH}> has {len(element.children)} children; at most 1"
            self.problems.error("children", element.children[1].place, message, "use <Sequence>")
        elif element.children:
            self._waiting.append((element.children[0], into_handler(handler)))
        elif not spec.tries_again:
            message = f"<momantu:{CATCH}> without a child is `again`"
            hint = "it has a meaning in <momantu:Recover> alone"
            self.problems.error("again", element.place, message, hint)


def _is_handler(element: Element) -> bool:
    if element.space == OURS:
        return element.name == CATCH
    identity = element.get("ID")
    explicit = not element.space and element.name in EXPLICIT
    return explicit and identity is not None and identity.value == PREFIX + CATCH

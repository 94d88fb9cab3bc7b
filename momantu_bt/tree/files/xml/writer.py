"""A Document as BehaviorTree.CPP's XML; our additions are in our namespace."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest
from typing import TypeAlias

from momantu_bt.tree.catalogue import EXPLICIT, NODES, SUBTREE, is_ours
from momantu_bt.tree.files.scalars import CannotWrite, literal, port_text
from momantu_bt.tree.files.syntax import OURS
from momantu_bt.tree.files.xml.attributes import AttributeWriter, is_name, plain
from momantu_bt.tree.files.xml.header import FORMAT
from momantu_bt.tree.files.xml.models import PORTS
from momantu_bt.tree.files.xml.nodes import ONCE, PORT
from momantu_bt.tree.files.xml.ports import CATCH, PREFIX
from momantu_bt.tree.files.xml.text import above, attribute, beside, escaped
from momantu_bt.tree.language import VERSION
from momantu_bt.tree.model import Document, Handler, Literal, Node, NodeModel, PortDeclaration, Tree
from momantu_bt.tree.registry import Registry
from momantu_bt.values.cpp_types import model_type

__all__ = ["CannotWrite", "write"]

_STEP = "  "
_TAGS = {direction: tag for tag, direction in PORTS.items()}


def write(document: Document, registry: Registry | None = None) -> str:
    """The document's own trees in XML. Trees that it includes stay in their files.

    registry: its skills' port types tell texts from numbers. The reader must have the same one.

    Raises:
        CannotWrite: something in it has no spelling in XML.
    """
    nodes = _NodeWriter(document, AttributeWriter(document, registry or Registry()))
    own = [tree for tree in document.trees.values() if tree.place.file == document.file]
    body = [_STEP + f"<include{attribute('path', include.path)}/>" for include in document.includes]
    body += _values(document)
    for tree in own:
        body += ["", *_tree(tree, nodes)] if body else _tree(tree, nodes)
    body += _models(document, own)
    end = above(document.comments, _STEP, every=True)
    lines = ['<?xml version="1.0" encoding="UTF-8"?>']
    lines += above(document.header_comments, "", every=True)
    lines += [_root(document, body), *body, *end, "</root>"]
    return "\n".join(lines) + "\n"


def _root(document: Document, body: list[str]) -> str:
    words = attribute("BTCPP_format", FORMAT) + attribute("main_tree_to_execute", document.main)
    if document.world is not None or any(PREFIX in line for line in body):
        words += attribute("xmlns:momantu", OURS) + attribute(f"{PREFIX}version", str(VERSION))
    if document.world is not None:
        words += attribute(f"{PREFIX}world", document.world)
    return f"<root{words}>"


def _values(document: Document) -> list[str]:
    if not document.values:
        return []
    lines = [f"{_STEP}<{PREFIX}Values>"]
    for name, value in document.values.items():
        comments = document.value_comments.get(name, ())
        shown = escaped(literal(value.value))
        element = f"<{PREFIX}Value{attribute('key', name)}>{shown}</{PREFIX}Value>"
        lines += above(comments, _STEP * 2)
        lines.append(_STEP * 2 + element + beside(comments))
    return [*lines, f"{_STEP}</{PREFIX}Values>"]


def _tree(tree: Tree, nodes: _NodeWriter) -> list[str]:
    words = attribute("ID", tree.name)
    if tree.doc:
        words += attribute(f"{PREFIX}doc", tree.doc)
    lines = [*above(tree.comments, _STEP), f"{_STEP}<BehaviorTree{words}>{beside(tree.comments)}"]
    return [*lines, *nodes.lines(tree.root, _STEP * 2), f"{_STEP}</BehaviorTree>"]


# models


def _models(document: Document, own: list[Tree]) -> list[str]:
    lines = [line for model in document.models for line in _node_model(model)]
    for tree in own:
        if not tree.open:
            ports = [line for port in tree.ports.values() for line in _tree_port(port)]
            lines += _model(f"<SubTree{attribute('ID', tree.name)}", ports)
    return ["", f"{_STEP}<TreeNodesModel>", *lines, f"{_STEP}</TreeNodesModel>"] if lines else []


def _model(start: str, inside: list[str]) -> list[str]:
    name = start[1:].partition(" ")[0]
    if not inside:
        return [f"{_STEP * 2}{start}/>"]
    return [f"{_STEP * 2}{start}>", *inside, f"{_STEP * 2}</{name}>"]


def _tree_port(port: PortDeclaration) -> list[str]:
    words = attribute("name", port.name)
    if port.type_name != "any":
        words += attribute("type", port.type_name)
    if port.default is not None:
        text = plain(port.default, port.name, model_type(port.type_name))
        shown = port_text(port.default)
        words += (
            attribute(f"{PREFIX}default", shown) if text is None else attribute("default", text)
        )
    comments = [*above(port.comments, _STEP * 3)]
    return [*comments, _port(port, words) + beside(port.comments)]


def _port(port: PortDeclaration, words: str) -> str:
    tag = _TAGS[port.direction]
    if port.doc and port.doc != " ".join(port.doc.split()):
        words, inside = words + attribute(f"{PREFIX}doc", port.doc), ""
    else:
        inside = escaped(port.doc)
    return _STEP * 3 + f"<{tag}{words}" + (f">{inside}</{tag}>" if inside else "/>")


def _node_model(model: NodeModel) -> list[str]:
    inside: list[str] = []
    for port in model.ports:
        words = attribute("name", port.name)
        words += attribute("type", port.type_name) if port.type_name else ""
        if isinstance(port.default, Literal):
            words += attribute("default", str(port.default.value))
        inside += [*above(port.comments, _STEP * 3), _port(port, words) + beside(port.comments)]
    if model.metadata:
        pairs = (f"{_STEP * 4}<Metadata{_pair(*pair)}/>" for pair in model.metadata)
        inside += [f"{_STEP * 3}<MetadataFields>", *pairs, f"{_STEP * 3}</MetadataFields>"]
    start = f"<{model.kind}{attribute('ID', model.name)}"
    if model.editable is not None:
        start += attribute("editable", "true" if model.editable else "false")
    return _model(start, inside)


def _pair(name: str, value: str) -> str:
    if not is_name(name):
        raise CannotWrite(f"{name!r} cannot be the name of an attribute")
    return attribute(name, value)


# nodes

_Piece: TypeAlias = "str | tuple[Node, str]"


@dataclass(frozen=True, slots=True)
class _NodeWriter:
    """Writes nodes with a stack, not by recursion."""

    document: Document
    attributes: AttributeWriter

    def lines(self, root: Node, pad: str) -> list[str]:
        lines: list[str] = []
        stack: list[_Piece] = [(root, pad)]
        while stack:
            piece = stack.pop()
            if isinstance(piece, str):
                lines.append(piece)
                continue
            try:
                stack.extend(reversed(list(self._node(*piece))))
            except CannotWrite as error:
                error.place = piece[0].place
                raise
        return lines

    def _node(self, node: Node, pad: str) -> Iterator[_Piece]:
        spec = NODES.get(node.type)
        cases = [f"case_{number + 1}" for number in range(spec.switch if spec is not None else 0)]
        remarks = {key: texts for key, texts in node.port_comments.items() if key not in cases}
        yield from above(node.comments, pad)
        yield from above([text for texts in remarks.values() for text in texts], pad, every=True)
        tag, identity = self._tag(node)
        start = f"{pad}<{tag}{identity}{self.attributes.of(node)}"
        apart = self.attributes.apart(node)
        if not (node.children or node.handlers or node.end_comments or apart):
            yield f"{start}/>{beside(node.comments)}"
            return
        yield f"{start}>{beside(node.comments)}"
        for name, text in apart:
            words = f"{PREFIX}{PORT}{attribute('name', name)}"
            yield f"{pad}{_STEP}<{words}>{escaped(text)}</{PREFIX}{PORT}>"
        for child, case in zip_longest(node.children, cases[: len(node.children)]):
            yield from above(node.port_comments.get(case, ()), pad + _STEP, every=True)
            yield child, pad + _STEP
        for handler in node.handlers:
            yield from self._handler(handler, pad + _STEP)
        yield from above(node.end_comments, pad + _STEP, every=True)
        yield f"{pad}</{tag}>"

    def _handler(self, handler: Handler, pad: str) -> Iterator[_Piece]:
        tag = f"{PREFIX}{CATCH}"
        start = f"{pad}<{tag}{attribute('codes', ' | '.join(handler.codes))}"
        yield from above(handler.comments, pad)
        if handler.node is None:
            yield f"{start}/>{beside(handler.comments)}"
        else:
            yield f"{start}>{beside(handler.comments)}"
            yield handler.node, pad + _STEP
            yield f"{pad}</{tag}>"

    def _tag(self, node: Node) -> tuple[str, str]:
        """The tag, and the attribute that says what the node is if the tag cannot."""
        if is_ours(node.type):
            return PREFIX + node.type, ""
        if node.type in NODES or node.type == SUBTREE:
            return node.type, ""
        taken = (*EXPLICIT, *ONCE, *self.document.trees)
        if is_name(node.type) and node.type not in taken:
            return node.type, ""
        if node.type in self.document.trees:
            raise CannotWrite(f"{node.type} is the name of a tree and of another node")
        kinds = {0: "Action", 1: "Decorator"}
        return kinds.get(len(node.children), "Control"), attribute("ID", node.type)

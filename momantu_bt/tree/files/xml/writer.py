"""A Document as BehaviorTree.CPP's XML; our additions are in our namespace."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest
from typing import TypeAlias

from momantu_bt.tree.catalogue import NODES, SUBTREE
from momantu_bt.tree.files.scalars import CannotWrite, literal
from momantu_bt.tree.files.syntax import OURS
from momantu_bt.tree.files.xml.attributes import AttributeWriter
from momantu_bt.tree.files.xml.header import FORMAT
from momantu_bt.tree.files.xml.model_writer import model_lines, tree_model_lines
from momantu_bt.tree.files.xml.nodes import PORT
from momantu_bt.tree.files.xml.parts import usual_order
from momantu_bt.tree.files.xml.ports import CATCH, DESCRIPTION, PREFIX
from momantu_bt.tree.files.xml.tags import Tags
from momantu_bt.tree.files.xml.text import above, attribute, beside, escaped
from momantu_bt.tree.language import VERSION
from momantu_bt.tree.model import BROKEN, Document, Handler, Include, Node, Tree
from momantu_bt.tree.registry import Registry

__all__ = ["CannotWrite", "write"]

_STEP = "  "
_OURS = re.compile(rf"^ *</?{PREFIX}|^ *<[^!].* {PREFIX}")
"""A line that uses our prefix. Texts with it inside attributes count too; they do no harm."""


def write(document: Document, registry: Registry | None = None) -> str:
    """The document's own trees in XML. Trees that it includes stay in their files.

    registry: its skills' port types tell texts from numbers. The reader must have the same one.

    Raises:
        CannotWrite: something in it has no spelling in XML.
    """
    ports = {name: tree.ports for name, tree in document.trees.items()}
    attributes = AttributeWriter(ports, registry or Registry())
    nodes = _NodeWriter(Tags.of(document), attributes)
    own = [tree for tree in document.trees.values() if tree.place.file == document.file]
    body = _body(document, own, nodes)
    lines = ['<?xml version="1.0" encoding="UTF-8"?>']
    lines += above(document.header_comments, "", every=True)
    lines += [_root(document, body), *body, *above(document.comments, _STEP, every=True), "</root>"]
    return "\n".join([*lines, *above(document.after_comments, "", every=True)]) + "\n"


def _body(document: Document, own: list[Tree], nodes: _NodeWriter) -> list[str]:
    """All parts of the file in their order."""
    parts = {
        "include": iter([_include(include) for include in document.includes]),
        "values": iter([_values(document)]),
        "tree": iter([_tree(tree, nodes) for tree in own]),
        "models": iter([_models(document, own)]),
    }
    body: list[str] = []
    for part in document.order or usual_order(document):
        lines = next(parts[part], [])
        apart = body and part in ("tree", "models")
        body += ["", *lines] if apart else lines
    for rest in parts.values():  # an order that names too few of them
        body += [line for lines in rest for line in lines if document.order]
    return body


def _include(include: Include) -> list[str]:
    words = "" if include.package is None else attribute("ros_pkg", include.package)
    words += attribute("path", include.path) if include.path or not include.attributes else ""
    words += "".join(attribute(name, text) for name, text in include.attributes)
    return [*above(include.comments, _STEP, every=True), f"{_STEP}<include{words}/>"]


def _root(document: Document, body: list[str]) -> str:
    words = attribute("BTCPP_format", FORMAT)
    if document.main_named:
        words += attribute("main_tree_to_execute", document.missing_main or document.main)
    words += "".join(attribute(name, text) for name, text in document.attributes.items())
    ours = (document.world, document.goal) != (None, None)
    if ours or any(_OURS.search(line) for line in body):
        words += attribute("xmlns:momantu", OURS) + attribute(f"{PREFIX}version", str(VERSION))
    if document.world is not None:
        words += attribute(f"{PREFIX}world", document.world)
    if document.goal is not None:
        words += attribute(f"{PREFIX}goal", literal(document.goal.value))
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
    words = "" if tree.unnamed else attribute("ID", tree.name)
    words += attribute(DESCRIPTION, tree.doc) if tree.doc else ""
    words += "".join(attribute(name, text) for name, text in tree.attributes.items())
    lines = [*above(tree.comments, _STEP), f"{_STEP}<BehaviorTree{words}>{beside(tree.comments)}"]
    for root in (tree.root, *tree.further):
        lines += nodes.lines(root, _STEP * 2)
    lines += above(tree.end_comments, _STEP * 2, every=True)
    return [*lines, f"{_STEP}</BehaviorTree>"]


def _models(document: Document, own: list[Tree]) -> list[str]:
    kept = {model.name for model in document.models if model.kind == SUBTREE}
    lines = [line for model in document.models for line in model_lines(model)]
    for tree in own:
        if not tree.open and tree.name not in kept:
            lines += tree_model_lines(tree)
    lines += above(document.models_end_comments, _STEP * 2, every=True)
    words = "".join(attribute(name, text) for name, text in document.models_attributes.items())
    if not lines and "models" not in document.order:
        return []
    start = f"{_STEP}<TreeNodesModel{words}>{beside(document.models_comments)}"
    return [*above(document.models_comments, _STEP), start, *lines, f"{_STEP}</TreeNodesModel>"]


# nodes

_Piece: TypeAlias = "str | tuple[Node, str]"


@dataclass(frozen=True, slots=True)
class _NodeWriter:
    """Writes nodes with a stack, not by recursion."""

    tags: Tags
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
        if node.type == BROKEN and node.tag is None:
            return
        tag, name = self.tags.written(node)
        identity = "" if name is None else attribute("ID", name)
        start = f"{pad}<{tag}{identity}{self.attributes.of(node)}"
        apart = self.attributes.apart(node)
        if not (node.children or node.handlers or node.end_comments or apart):
            text = escaped(node.text, between=True)
            end = f">{text}</{tag}>" if text else "/>"
            yield f"{start}{end}{escaped(node.tail, between=True)}{beside(node.comments)}"
            return
        yield f"{start}>{escaped(node.text, between=True)}{beside(node.comments)}"
        for name, text in apart:
            words = f"{PREFIX}{PORT}{attribute('name', name)}"
            yield f"{pad}{_STEP}<{words}>{escaped(text)}</{PREFIX}{PORT}>"
        for child, case in zip_longest(node.children, cases[: len(node.children)]):
            yield from above(node.port_comments.get(case, ()), pad + _STEP, every=True)
            yield child, pad + _STEP
        for handler in node.handlers:
            yield from self._handler(handler, pad + _STEP)
        yield from above(node.end_comments, pad + _STEP, every=True)
        yield f"{pad}</{tag}>{escaped(node.tail, between=True)}"

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

"""A Document as YAML, as a person would write it: header, values, trees with their ports."""

from __future__ import annotations

from collections.abc import Sequence

from momantu_bt.formats.yaml.writer import scalar
from momantu_bt.tree.files.scalars import CannotWrite, literal, port_text
from momantu_bt.tree.files.yaml.leaf_writer import LeafWriter
from momantu_bt.tree.files.yaml.lines import WIDTH, above, beside, spread
from momantu_bt.tree.files.yaml.models import write_models
from momantu_bt.tree.files.yaml.node_writer import NodeWriter
from momantu_bt.tree.files.yaml.words import HEADER, PORTS
from momantu_bt.tree.language import VERSION
from momantu_bt.tree.model import Document, PortDeclaration, Tree
from momantu_bt.tree.registry import Registry

__all__ = ["CannotWrite", "write"]


def write(document: Document, registry: Registry | None = None) -> str:
    """The document's own trees in YAML. Trees that it includes stay in their files.

    registry: the skills. A known skill's only value may be written without its port's name.

    Raises:
        CannotWrite: something in it has no spelling in YAML.
    """
    lines = _header(document)
    if document.values:
        lines += ["", "values:", *_values(document)]
    if document.models:
        lines += ["", "models:", *write_models(document.models)]
    own = [tree for tree in document.trees.values() if tree.place.file == document.file]
    lines += ["", "trees:"]
    writer = NodeWriter(LeafWriter(frozenset(document.trees), registry or Registry()))
    for index, tree in enumerate(own):
        lines += ([""] if index else []) + _tree(tree, writer)
    lines += above(document.comments, "")
    return "\n".join(lines) + "\n"


def _header(document: Document) -> list[str]:
    lines = [*above(document.header_comments, "", every=True), f"momantu_bt: {VERSION}"]
    if document.includes:
        paths = ", ".join(scalar(include.path, flow=True) for include in document.includes)
        lines.append(f"include: [{paths}]")
    if document.world is not None:
        lines.append(f"world: {scalar(document.world)}")
    return [*lines, f"main: {scalar(document.main, typed=False)}"]


def _values(document: Document) -> list[str]:
    lines: list[str] = []
    for name, value in document.values.items():
        comments = document.value_comments.get(name, ())
        lines += above(comments, "  ")
        lines += spread(value, f"  {scalar(name)}:", literal(value.value), comments)
    return lines


def _tree(tree: Tree, writer: NodeWriter) -> list[str]:
    ports = _ports(tree)
    lead = f"  {scalar(tree.name)}:"
    lines = above(tree.comments, "  ")
    if not ports:
        body = writer.value(tree.root, lead, 4, taken=HEADER, comments=tree.comments)
        return [*lines, *body]
    body = writer.body(tree.root, 4, taken=HEADER)
    return [*lines, lead + beside(tree.comments), *ports, *body]


def _ports(tree: Tree) -> list[str]:
    lines = [f"    doc: {scalar(tree.doc)}"] if tree.doc else []
    if tree.open:
        lines.append("    open: true")
    for key, direction in PORTS.items():
        declared = [port for port in tree.ports.values() if port.direction == direction]
        if declared:
            lines += _declarations(key, declared)
    return lines


def _declarations(key: str, declared: Sequence[PortDeclaration]) -> list[str]:
    inside = ", ".join(_declaration(port) for port in declared)
    line = f"    {key}: {{{inside}}}"
    if len(line) <= WIDTH and not any(port.comments for port in declared):
        return [line]
    lines = [f"    {key}:"]
    for port in declared:
        line = " " * 6 + _declaration(port) + beside(port.comments)
        lines += [*above(port.comments, " " * 6), line]
    return lines


def _declaration(port: PortDeclaration) -> str:
    name, type_name = scalar(port.name, flow=True), scalar(port.type_name, flow=True)
    if port.default is None and not port.doc:
        return f"{name}: {type_name}"
    parts = [f"type: {type_name}"]
    if port.default is not None:
        parts.append(f"default: {port_text(port.default, flow=True)}")
    if port.doc:
        parts.append(f"doc: {scalar(port.doc, flow=True)}")
    return f"{name}: {{{', '.join(parts)}}}"

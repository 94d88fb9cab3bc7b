"""A Document as YAML, as a person would write it: header, values, trees with their ports."""

from __future__ import annotations

from collections.abc import Sequence

from momantu_bt.formats.yaml.writer import scalar
from momantu_bt.tree.catalogue import SUBTREE
from momantu_bt.tree.files.scalars import CannotWrite, literal, port_text
from momantu_bt.tree.files.xml.tags import Tags
from momantu_bt.tree.files.yaml.leaf_writer import LeafWriter
from momantu_bt.tree.files.yaml.lines import WIDTH, above, beside, spread
from momantu_bt.tree.files.yaml.model_writer import metadata_lines, model_lines
from momantu_bt.tree.files.yaml.node_writer import NodeWriter
from momantu_bt.tree.files.yaml.parts import document_xml, include_text, tree_lines
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
    apart = document.comments_apart
    lines = _header(document, comments=not apart)
    lines += document_xml(document, comments=apart)
    if document.values:
        lines += ["", "values:", *_values(document)]
    own = [tree for tree in document.trees.values() if tree.place.file == document.file]
    leaves = LeafWriter(frozenset(document.trees), registry or Registry())
    writer = NodeWriter(leaves, Tags.of(document))
    lines += ["", "trees:"] if own else []
    kept = {model.name for model in document.models if model.kind == SUBTREE}
    for index, tree in enumerate(own):
        ports = _ports(tree, declared=tree.name not in kept)
        ports += tree_lines(tree, comments=tree.comments_apart)
        body = _tree(tree, ports, writer, comments=not tree.comments_apart)
        lines += ([""] if index else []) + body
    lines += _models(document, comments=apart)
    lines += [] if apart else above(document.comments, "")
    return "\n".join(lines) + "\n"


def _models(document: Document, *, comments: bool) -> list[str]:
    if not document.models:
        return ["", "models: []"] if "models" in document.order else []
    remarks = () if comments else document.models_comments
    inside = model_lines(document.models, comments=comments)
    return ["", *above(remarks, ""), f"models:{beside(remarks)}", *inside]


def _header(document: Document, *, comments: bool) -> list[str]:
    remarks = document.header_comments if comments else ()
    lines = [*above(remarks, "", every=True), f"momantu_bt: {VERSION}"]
    if document.includes:
        paths = ", ".join(include_text(include) for include in document.includes)
        lines.append(f"include: [{paths}]")
    if document.world is not None:
        lines.append(f"world: {scalar(document.world)}")
    if document.goal is not None:
        lines.append(f"goal: {literal(document.goal.value)}")
    if not document.main_named:
        return lines
    main = document.missing_main or document.main
    return [*lines, f"main: {scalar(main, typed=False)}"]


def _values(document: Document) -> list[str]:
    lines: list[str] = []
    for name, value in document.values.items():
        comments = document.value_comments.get(name, ())
        lines += above(comments, "  ")
        lines += spread(value, f"  {scalar(name)}:", literal(value.value), comments)
    return lines


def _tree(tree: Tree, ports: list[str], writer: NodeWriter, *, comments: bool) -> list[str]:
    remarks = tree.comments if comments else ()
    lead = f"  {scalar(tree.name)}:"
    lines = above(remarks, "  ")
    end = above(tree.end_comments if comments else (), "    ", every=True)
    roots = [tree.root, *tree.further] if not writer.is_nothing(tree.root) else []
    if len(roots) != 1:
        start = "    nodes:" + ("" if roots else " []")
        body = [start, *(line for root in roots for line in writer.item(root, 6))]
    elif not ports:
        body = writer.value(tree.root, lead, 4, taken=HEADER, comments=remarks)
        return [*lines, *body, *end]
    else:
        body = writer.body(tree.root, 4, taken=HEADER)
    return [*lines, lead + beside(remarks), *ports, *body, *end]


def _ports(tree: Tree, *, declared: bool) -> list[str]:
    """What stands above a tree's nodes. declared: whether its ports stand here, not in a model."""
    lines = [f"    doc: {scalar(tree.doc)}"] if tree.doc else []
    if tree.open:
        lines.append("    open: true")
    if not declared:
        return lines
    fields = [line for each in tree.metadata for line in metadata_lines(each, "    ")]
    first = any(each.at == 0 for each in tree.metadata)
    lines += fields if first else []
    for key, direction in PORTS.items():
        ports = [port for port in tree.ports.values() if port.direction == direction]
        if ports:
            lines += _declarations(key, ports)
    return lines if first else lines + fields


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
    name = scalar(port.name, flow=True)
    type_name = scalar(port.written_type or port.type_name, flow=True)
    if port.default is None and not port.doc:
        return f"{name}: {type_name}"
    parts = [f"type: {type_name}"]
    if port.default is not None:
        parts.append(f"default: {port_text(port.default, flow=True)}")
    if port.doc:
        parts.append(f"doc: {scalar(port.doc, flow=True)}")
    return f"{name}: {{{', '.join(parts)}}}"

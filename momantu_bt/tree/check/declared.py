"""Nodes that no plug-in offers: what a file's models say of them, or else what their uses show."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace

from momantu_bt.skill import MISSING, Port
from momantu_bt.tree.catalogue.codes import UNKNOWN, Codes, Failing
from momantu_bt.tree.catalogue.flow import After, Flow, Walk, as_written
from momantu_bt.tree.catalogue.known import Key, Known
from momantu_bt.tree.catalogue.nodes import theirs
from momantu_bt.tree.catalogue.spec import Kind, NodeSpec
from momantu_bt.tree.catalogue.words import AUTOREMAP, SUBTREE
from momantu_bt.tree.model import Document, Literal, Node, NodeModel, PortDeclaration
from momantu_bt.values.cpp_types import model_type

_WIRE = re.compile(r" *\{(\w+|=)\} *")
_KINDS = {"Control": Kind.CONTROL, "Decorator": Kind.DECORATOR}
_CHILDREN: Mapping[Kind, tuple[int, int | None]] = {
    Kind.LEAF: (0, 0),
    Kind.DECORATOR: (1, 1),
    Kind.CONTROL: (1, None),
}


def models_of(document: Document) -> dict[str, NodeModel]:
    """The models of nodes in a file and in the files that it includes; the file's own count."""
    return {theirs(each.name): each for each in _models(document) if each.kind != SUBTREE}


def tree_models_of(document: Document) -> dict[str, NodeModel]:
    """The models of trees that the file does not have, as the file or its includes have them."""
    return {each.name: each for each in _models(document) if each.kind == SUBTREE}


def _models(document: Document) -> Iterator[NodeModel]:
    return reversed((*document.models, *document.further_models))


def declared_spec(model: NodeModel) -> NodeSpec:
    """What a file's model says of a node."""
    kind = _KINDS.get(model.kind, Kind.LEAF)
    ports = {port.name: declared_port(port) for port in model.ports}
    return NodeSpec(
        model.name,
        (model.name,),
        kind,
        "",
        ports,
        first=next((name for name, port in ports.items() if port.direction == "in"), None),
        children=_CHILDREN[kind],
        positions=("child",) if kind is Kind.DECORATOR else (),
        flow=_declared_flow(model) if kind is Kind.LEAF else _any_flow,
        codes=_any_code,
    )


def used_spec(node: Node) -> NodeSpec:
    """What one node of an unknown kind shows: it may read and write each key that it names."""
    names = [name for name in node.ports if name != AUTOREMAP]
    ports = {name: Port(name, "inout", object, "", None) for name in names}
    kind = Kind.CONTROL if node.children else Kind.LEAF
    spec = NodeSpec(node.type, (node.type,), kind, "", ports, children=(0, None))
    return replace(spec, flow=_any_flow, codes=_any_code)


def declared_port(declaration: PortDeclaration) -> Port:
    """The port of a model. Outputs need not be wired; an input without a default is required."""
    default = None if declaration.direction != "in" else MISSING
    if isinstance(declaration.default, Literal):
        default = declaration.default.value
    type_ = model_type(declaration.type_name)
    return Port(declaration.name, declaration.direction, type_, declaration.doc, default)


def default_key(declaration: PortDeclaration) -> str | None:
    """The key that a port is wired to where a node does not give it: `default="{key}"`."""
    default = declaration.default
    text = str(default.value) if isinstance(default, Literal) else ""
    found = _WIRE.fullmatch(text)
    return None if found is None else found[1].replace("=", declaration.name)


def _declared_flow(model: NodeModel) -> Flow:
    """The flow of a leaf: after success its outputs are written, also those wired by default."""
    keys = {port.name: default_key(port) for port in model.ports if port.direction != "in"}
    by_default = {name: key for name, key in keys.items() if key is not None}

    def flow(walk: Walk, node: Node, before: Known) -> After:
        end = as_written(walk, node, before)
        written = {k: Key(object, node.place) for n, k in by_default.items() if n not in node.ports}
        return After(end.success.having_all(written), end.failure, end.skipped)

    return flow


def _any_flow(walk: Walk, node: Node, before: Known) -> After:
    """The flow of a node of which nothing is known: whatever it may write counts as written."""
    known = walk.outputs(node, before).rewritten(walk.rewritten(node))
    for child in node.children:
        end = walk(child, known)
        known = next((each for each in (end.passed, end.failure) if each.reached), known)
    return After(known, known)


def _any_code(node: Node, failing: Failing) -> Codes:
    return frozenset({UNKNOWN})

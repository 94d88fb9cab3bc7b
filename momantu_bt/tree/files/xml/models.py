"""TreeNodesModel: the ports of the file's trees, and models of leaves, which are kept."""

from __future__ import annotations

from dataclasses import dataclass, field

from momantu_bt.formats.names import nearest, valid_names
from momantu_bt.formats.xml.elements import Attribute, Element
from momantu_bt.tree.catalogue import EXPLICIT, SUBTREE
from momantu_bt.tree.files.port_values import KEY
from momantu_bt.tree.files.syntax import OURS
from momantu_bt.tree.files.xml.values import WireError, attribute_value, flow_value
from momantu_bt.tree.model import (
    Literal,
    NodeModel,
    PortDeclaration,
    PortValue,
    Reference,
    Template,
)
from momantu_bt.tree.problems import Problems
from momantu_bt.values.cpp_types import our_type
from momantu_bt.values.types import parse_type

PORTS = {"input_port": "in", "output_port": "out", "inout_port": "inout"}
"""Elements of a model, and the direction they mean."""
_PORT_WORDS = ("name", "type", "default", "description")
_METADATA = "MetadataFields"


@dataclass(slots=True)
class Models:
    """A file's TreeNodesModel. trees: ports by tree; leaves: all other models."""

    trees: dict[str, dict[str, PortDeclaration]] = field(default_factory=dict)
    leaves: list[NodeModel] = field(default_factory=list)


def read_models(root: Element, problems: Problems) -> Models:
    """Every model of a file."""
    models = Models()
    for section in (each for each in root.children if each.name == "TreeNodesModel"):
        for element in section.children:
            _read_model(element, models, problems)
    return models


def _read_model(element: Element, models: Models, problems: Problems) -> None:
    identity = element.get("ID")
    if element.name not in (SUBTREE, *EXPLICIT) or element.space:
        hint = valid_names(element.name, (*EXPLICIT, SUBTREE), "models")
        message = f"a model is not <{element.said}>"
        problems.error("unknown-key", element.place, message, hint)
        return
    if identity is None or not identity.value:
        message = f"<{element.name}> does not say which node it is a model of"
        problems.error("bad-name", element.place, message, f'write <{element.name} ID="name">')
        return
    if element.name == SUBTREE:
        _check_model_of_tree(element, problems)
        models.trees.setdefault(identity.value, _tree_ports(element, problems))
        return
    ports = tuple(p for each in element.children if (p := _port(each, problems)) is not None)
    metadata = tuple(
        (attribute.name, attribute.value)
        for each in element.children
        if each.name == _METADATA
        for pair in each.children
        for attribute in pair.attributes
    )
    editable = element.get("editable")
    shown = None if editable is None else editable.value == "true"
    models.leaves.append(NodeModel(identity.value, element.name, ports, shown, metadata))


def _check_model_of_tree(element: Element, problems: Problems) -> None:
    """Report mistakes in the ports of a tree."""
    if ">" in element.text:
        place = element.text_place or element.place
        problems.error("unknown-key", place, "a text and no port", "a `<` may be missing")
    for port in element.children:
        for attribute in port.attributes:
            meant = None if attribute.space else nearest(attribute.name, _PORT_WORDS)
            if meant is not None and attribute.name not in _PORT_WORDS:
                message, hint = f"a port has no {attribute.name!r}", f"did you mean {meant}?"
                problems.error("unknown-key", attribute.name_place, message, hint)


def _tree_ports(element: Element, problems: Problems) -> dict[str, PortDeclaration]:
    ports: dict[str, PortDeclaration] = {}
    for each in element.children:
        port = _port(each, problems)
        if port is None:
            continue
        if not KEY.fullmatch(port.name):
            hint = "letters, digits and underscores, no digit first"
            message = f"{port.name!r} cannot be the name of a key"
            problems.error("bad-name", port.place, message, hint)
        elif port.name in ports:
            message = f"the port {port.name!r} stands here twice"
            problems.error("duplicate-key", port.place, message)
        else:
            ports[port.name] = _of_tree(port, each, problems)
    return ports


def _port(element: Element, problems: Problems) -> PortDeclaration | None:
    """A port as it is written: the name of its type, and its default as a text."""
    if element.name == _METADATA:
        return None
    name = element.get("name")
    if element.name not in PORTS or name is None:
        hint = 'write <input_port name="…"/>, or output_port or inout_port'
        problems.error("unknown-key", element.place, f"<{element.said}> is not a port", hint)
        return None
    type_, default = element.get("type"), element.get("default")
    doc = element.get("doc", OURS)
    return PortDeclaration(
        name.value,
        PORTS[element.name],
        "" if type_ is None else type_.value,
        name.place if type_ is None else type_.place,
        None if default is None else Literal(default.value),
        " ".join(element.text.split()) if doc is None else doc.value,
        comments=element.comments,
    )


def _of_tree(port: PortDeclaration, element: Element, problems: Problems) -> PortDeclaration:
    """The port with our type, and its default as a value of that type."""
    type_name = our_type(port.type_name)
    default, own = element.get("default"), element.get("default", OURS)
    value: PortValue | None = None
    if own is not None:
        value = flow_value(own.value, port.name, own.place, problems)
    elif default is not None:
        value = _default(port.name, type_name, default, problems)
    if isinstance(value, Template) or (isinstance(value, Reference) and value.fields):
        message = "a default is a value, or one key of whoever runs the tree"
        problems.error("wire-inside", (own or port).place, message, "write the value, or $key")
        value = None
    return PortDeclaration(
        port.name, port.direction, type_name, port.place, value, port.doc, port.comments
    )


def _default(port: str, type_name: str, default: Attribute, problems: Problems) -> PortValue | None:
    try:
        type_ = parse_type(type_name)
    except KeyError:  # the checker reports that the type is unknown
        type_ = object
    try:
        return attribute_value(default.value, port, type_)
    except WireError as error:
        problems.error("not-a-key", default.place, str(error), "write {key}, or a value")
        return None

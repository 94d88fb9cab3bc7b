"""TreeNodesModel: the ports of the file's trees, and models of all nodes, which are kept whole."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

from momantu_bt.formats.names import nearest, valid_names
from momantu_bt.formats.places import Place
from momantu_bt.formats.text import Beside
from momantu_bt.formats.xml.elements import Attribute, Element
from momantu_bt.tree.catalogue import EXPLICIT, SUBTREE
from momantu_bt.tree.files.port_values import KEY
from momantu_bt.tree.files.syntax import OURS
from momantu_bt.tree.files.xml.values import WireError, attribute_value, flow_value
from momantu_bt.tree.model import (
    Literal,
    MetadataFields,
    NodeModel,
    PortDeclaration,
    PortValue,
    Reference,
    Template,
)
from momantu_bt.tree.problems import Problems
from momantu_bt.values.cpp_types import our_type
from momantu_bt.values.types import parse_type

PORTS = {
    "input_port": "in",
    "output_port": "out",
    "inout_port": "inout",
    "bidirectional_port": "inout",
}
"""Elements of a model, and the direction they mean."""
_KEPT = ("name", "type", "default")
_PORT_WORDS = ("name", "type", "default", "description")
METADATA = "MetadataFields"


@dataclass(slots=True)
class Models:
    """A file's TreeNodesModel. trees: ports by tree; all: every model in the order of the file.

    section: its element, if there is one.
    """

    trees: dict[str, dict[str, PortDeclaration]] = field(default_factory=dict)
    all: list[NodeModel] = field(default_factory=list)
    section: Element | None = None


def read_models(root: Element, problems: Problems) -> Models:
    """Every model of a file."""
    models = Models()
    for section in (each for each in root.children if each.name == "TreeNodesModel"):
        if models.section is not None:
            message, hint = "a second <TreeNodesModel>", "put its models into the first one"
            problems.error("unknown-key", section.place, message, hint)
            continue
        models.section = section
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
    ports = tuple(p for each in element.children if (p := _port(each, problems)) is not None)
    models.all.append(_kept(element, identity, ports))
    if element.name == SUBTREE:
        with problems.keeping():
            _check_model_of_tree(element, problems)
            models.trees.setdefault(identity.value, tree_ports(element, problems))


def _kept(element: Element, identity: Attribute, ports: tuple[PortDeclaration, ...]) -> NodeModel:
    """A model with everything that its element says."""
    editable = element.get("editable")
    known = None if editable is None else {"true": True, "false": False}.get(editable.value)
    attributes = tuple(
        (each.said, each.value)
        for each in element.attributes
        if each is not identity and (each is not editable or known is None)
    )
    return NodeModel(
        identity.value,
        element.name,
        ports,
        known,
        tuple(_metadata(element)),
        place=identity.place,
        attributes=attributes,
        comments=element.comments,
        end_comments=element.end_comments,
    )


def _metadata(model: Element) -> Iterator[MetadataFields]:
    """All that `<MetadataFields>` say, each with its comments."""
    at = 0
    for element in model.children:
        if element.name != METADATA:
            at += 1
            continue
        entries = tuple(
            tuple((each.said, each.value) for each in entry.attributes)
            for entry in element.children
        )
        yield MetadataFields(entries, at, tuple(_metadata_comments(element)))


def _metadata_comments(fields: Element) -> Iterator[tuple[int, str]]:
    """Comments in and before `<MetadataFields>`, each with what it stands before."""
    yield from ((-1, text) for text in fields.comments if not isinstance(text, Beside))
    yield from ((0, str(text)) for text in fields.comments if isinstance(text, Beside))
    for number, entry in enumerate(fields.children):
        for text in entry.comments:
            yield number + isinstance(text, Beside), str(text)
    yield from ((len(fields.children), text) for text in fields.end_comments)


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


def tree_ports(element: Element, problems: Problems) -> dict[str, PortDeclaration]:
    """The ports that the element of a tree's model declares, with our types."""
    raw = [(port, each) for each in element.children if (port := _port(each, problems))]
    return _by_name([_of_tree(port, each, problems) for port, each in raw], problems)


def declared_ports(model: NodeModel, problems: Problems) -> dict[str, PortDeclaration]:
    """The ports of a tree's model that is kept, with our types."""
    return _by_name([_of_tree(port, None, problems) for port in model.ports], problems)


def _by_name(declared: Sequence[PortDeclaration], problems: Problems) -> dict[str, PortDeclaration]:
    """The ports whose names are keys, each once. Others are reported."""
    ports: dict[str, PortDeclaration] = {}
    for port in declared:
        if not KEY.fullmatch(port.name):
            hint = "letters, digits and underscores, no digit first"
            message = f"{port.name!r} cannot be the name of a key"
            problems.error("bad-name", port.place, message, hint)
        elif port.name in ports:
            message = f"the port {port.name!r} stands here twice"
            problems.error("duplicate-key", port.place, message)
        else:
            ports[port.name] = port
    return ports


def _port(element: Element, problems: Problems) -> PortDeclaration | None:
    """A port as it is written: the name of its type, and its default as a text."""
    if element.name == METADATA:
        return None
    name = element.get("name")
    if element.name not in PORTS or name is None:
        hint = 'write <input_port name="…"/>, or output_port or inout_port'
        problems.error("unknown-key", element.place, f"<{element.said}> is not a port", hint)
        return None
    type_, default = element.get("type"), element.get("default")
    doc = element.get("doc", OURS)
    known = [each for each in (name, type_, default) if each is not None]
    known = [each for each in known if each.value or each is name or each is default]
    return PortDeclaration(
        name.value,
        PORTS[element.name],
        "" if type_ is None else type_.value,
        name.place if type_ is None else type_.place,
        None if default is None else Literal(default.value),
        element.text.strip() if doc is None else doc.value,
        comments=element.comments,
        tag=element.name if element.name == "bidirectional_port" else "",
        attributes=tuple(
            (each.said, each.value)
            for each in element.attributes
            if each not in known and each.space != OURS
        ),
    )


def _of_tree(port: PortDeclaration, element: Element | None, problems: Problems) -> PortDeclaration:
    """The port with our type, and its default as a value of that type."""
    type_name = our_type(port.type_name)
    own = None if element is None else element.get("default", OURS)
    place = port.place
    if element is not None and (default := element.get("default")) is not None:
        place = default.place
    value: PortValue | None = None
    if own is not None:
        value = flow_value(own.value, port.name, own.place, problems)
    elif isinstance(port.default, Literal):
        value = _default(port.name, type_name, str(port.default.value), place, problems)
    if isinstance(value, Template) or (isinstance(value, Reference) and value.fields):
        message = "a default is a value, or one key of whoever runs the tree"
        problems.error("wire-inside", (own or port).place, message, "write the value, or $key")
        value = None
    exact = element is not None and element.get("doc", OURS) is not None
    doc = port.doc if exact else " ".join(port.doc.split())
    written = "" if port.type_name in ("", type_name) else port.type_name
    return replace(
        port, type_name=type_name, default=value, doc=doc, written_type=written, attributes=()
    )


def _default(
    port: str, type_name: str, text: str, place: Place, problems: Problems
) -> PortValue | None:
    try:
        type_ = parse_type(type_name)
    except KeyError:  # the checker reports that the type is unknown
        type_ = object
    try:
        return attribute_value(text, port, type_)
    except WireError as error:
        problems.error("not-a-key", place, str(error), "write {key}, or a value")
        return None

"""`node:` and `subtree:`: nodes by a name that may be a word of YAML, or stand in another file."""

from __future__ import annotations

from collections.abc import Sequence

from momantu_bt.formats.places import Place
from momantu_bt.formats.xml.elements import Attribute, Element
from momantu_bt.formats.yaml.values import Entries, Items, Raw, Scalar
from momantu_bt.tree.catalogue import EXPLICIT, NODES, SUBTREE, NodeSpec
from momantu_bt.tree.files.yaml.kept import TAG, XML, attributes_of
from momantu_bt.tree.files.yaml.ports import read_ports
from momantu_bt.tree.files.yaml.reading import Reading
from momantu_bt.tree.files.yaml.words import RUNS
from momantu_bt.tree.model import BROKEN, Node


def read_named(
    key: Scalar, value: Raw, entries: Sequence[tuple[Scalar, Raw]], reading: Reading
) -> Node:
    """Read a node by its type in XML, or a tree by its name, with `ports:` and `children:` beside.

    entries: all keys of the mapping.
    """
    name = value.text if isinstance(value, Scalar) else ""
    if not isinstance(value, Scalar) or (not name and not value.quoted):
        what = "a tree" if key.text == RUNS else "a node"
        hint = f"such as `{key.text}: Name`, with `ports: {{…}}` below it"
        return reading.broken("wrong-value", value.place, f"the name of {what} stands here", hint)
    node = Node(BROKEN, key.place)
    if key.text == RUNS:
        node.type, node.target = SUBTREE, name
        node.condition_places["ID"] = value.place
    else:
        _find_type(node, name, value.place, entries, reading)
    spec = NODES.get(node.type)
    for companion, raw in entries:
        if companion.text == "ports":
            _read_ports(node, raw, spec, reading)
        elif companion.text == "children" and isinstance(raw, Items):
            reading.children(node, raw)
        elif companion.text == "children":
            reading.error("wrong-value", raw.place, "`children` is a list of nodes")
    return node


def _read_ports(node: Node, raw: Raw, spec: NodeSpec | None, reading: Reading) -> None:
    if not isinstance(raw, Entries):
        hint = "write `ports: {name: value}`"
        reading.error("wrong-value", raw.place, "`ports` is a mapping of names to values", hint)
    elif node.type == BROKEN:
        message = "the ports of a node that is not known stand under `attributes:`"
        reading.error("unknown-node", raw.place, message, "as texts in XML's spelling")
    else:
        read_ports(node, raw, spec, reading.problems)


def _find_type(
    node: Node,
    name: str,
    place: Place,
    entries: Sequence[tuple[Scalar, Raw]],
    reading: Reading,
) -> None:
    """Give a node the type that XML's reader finds for its name; BROKEN if there is none."""
    tag = _tag(entries)
    if not tag and reading.explicit and name not in (SUBTREE, *EXPLICIT):
        tag = EXPLICIT[0]
    attributes = attributes_of(entries, reading.problems)
    prefix, _, local = name.rpartition(":")
    element = Element(local, prefix, name, place, attributes)
    if tag in EXPLICIT:
        attributes.insert(0, Attribute("ID", "", name, place, place, "ID"))
        element = Element(tag, "", tag, place, attributes)
    reading.attributes.named(node, element)
    if node.type != BROKEN:  # what the attributes mean is read once its ports are known
        node.ports, node.conditions, node.name, node.note = {}, {}, None, None
        node.attributes, node.tag = {}, None


def _tag(entries: Sequence[tuple[Scalar, Raw]]) -> str:
    """The tag that a node's `xml:` names; empty if it names none."""
    for key, value in entries:
        for inner, tag in value.entries if key.text == XML and isinstance(value, Entries) else ():
            if inner.text == TAG and isinstance(tag, Scalar):
                return tag.text
    return ""

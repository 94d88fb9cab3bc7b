"""The ports of a node from YAML values."""

from __future__ import annotations

from momantu_bt.formats.names import nearest
from momantu_bt.formats.places import Place
from momantu_bt.formats.yaml.values import Entries, Items, Raw, Scalar
from momantu_bt.tree.catalogue import NODES, SPELLED, SUBTREE, Kind, NodeSpec
from momantu_bt.tree.catalogue.synonyms import in_spelling, meant_type
from momantu_bt.tree.files.port_values import KEY, drop_duplicates, port_value, reported_braces
from momantu_bt.tree.files.yaml.reading import Reading, said
from momantu_bt.tree.files.yaml.scripts import read_script
from momantu_bt.tree.model import BROKEN, FIRST_INPUT, Literal, Node, Reference
from momantu_bt.tree.problems import Problems
from momantu_bt.values.kinds import ScriptText


def read_leaf(node: Node, value: Raw, spec: NodeSpec | None, reading: Reading) -> None:
    """Read a node that has only ports. A value without a name is its first input."""
    if isinstance(value, Entries):
        if reported_braces(value, reading.problems):
            node.type = BROKEN
        else:
            read_ports(node, value, spec, reading.problems)
    elif isinstance(value, Items) and (near := _near_control(node)) is not None:
        message = f"no node is called {node.type!r}"
        reading.error("unknown-node", node.place, message, f"did you mean {near}?")
        node.type = BROKEN
    elif isinstance(value, Items):
        hint = f"write `{said(node)}: {{port: value}}`, or begin with `sequence:`"
        if node.type not in (SUBTREE, *NODES):
            hint += "; a control node of another package has to be installed"
        reading.misfit(node, value, f"{said(node)} takes ports, no list", hint)
    elif value.value is not None or value.quoted:
        name = FIRST_INPUT if spec is None else spec.first
        if name is None:
            reading.misfit(node, value, f"{said(node)} takes no value")
        else:
            read_port(node, (name, value.place), value, spec, reading.problems)


def read_ports(node: Node, raw: Entries, spec: NodeSpec | None, problems: Problems) -> None:
    """Read a mapping of ports to values."""
    drop_duplicates(raw, problems)
    for key, value in raw.entries:
        read_port(node, (key.text, key.place), value, spec, problems)


def read_port(
    node: Node, named: tuple[str, Place], value: Raw, spec: NodeSpec | None, problems: Problems
) -> None:
    """Read one port. named: its name, and the place of the name."""
    name, place = named
    node.port_places[name] = value.place
    node.port_name_places[name] = place
    if spec is not None and name in spec.ports and spec.ports[name].type is ScriptText:
        script = read_script(value, problems, asked=name in spec.asks)
        if script is not None:
            node.ports[name] = Literal(script)
        elif spec.kind is Kind.LEAF and isinstance(value, Scalar):
            node.type = BROKEN  # it may read and write whatever it names
            node.ports = {key: Reference(key) for key in KEY.findall(value.text)}
        return
    found = port_value(value, name, problems)
    node.ports[name] = Reference(BROKEN) if found is None else found


def is_empty(value: Raw) -> bool:
    """Whether the file has no value here."""
    return isinstance(value, Scalar) and value.value is None and not value.quoted


def _near_control(node: Node) -> str | None:
    """The node that an unknown name with a list probably means."""
    if node.type in (SUBTREE, *NODES):
        return None
    meant = meant_type(node.type)
    if meant is not None and NODES[meant].kind is Kind.CONTROL:
        return in_spelling(meant, xml=False)
    controls = [name for name, spec in SPELLED.items() if spec.kind is Kind.CONTROL]
    return nearest(node.type, controls)

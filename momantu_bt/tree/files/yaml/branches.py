"""Nodes whose children are beside their key: `if` with `then`, `switch` with `cases`."""

from __future__ import annotations

from momantu_bt.formats.yaml.values import Entries, Items, Raw, Scalar
from momantu_bt.tree.catalogue import NODES, SWITCHES
from momantu_bt.tree.files.port_values import drop_duplicates
from momantu_bt.tree.files.yaml.children import read_control
from momantu_bt.tree.files.yaml.ports import read_port
from momantu_bt.tree.files.yaml.reading import Reading, said
from momantu_bt.tree.files.yaml.scripts import as_condition
from momantu_bt.tree.files.yaml.words import COMPANIONS, SWITCH
from momantu_bt.tree.model import BROKEN, Node


def read_branches(
    node: Node, value: Raw, companions: list[tuple[Scalar, Raw]], reading: Reading
) -> None:
    """Read `if:` or `while_do:`, and the keys beside it."""
    places = {key.text: raw for key, raw in companions}
    reading.later(as_condition(value) or value, node.children.append)
    for name in COMPANIONS[NODES[node.type].yaml[0]]:
        if name in places:
            reading.later(places[name], node.children.append)
        elif name != "else":
            hint = f"write `{name}:` beside it, and below that the node that runs then"
            reading.error("missing-child", node.place, f"`{said(node)}` without `{name}:`", hint)


def read_switch(
    key: Scalar, value: Raw, companions: list[tuple[Scalar, Raw]], reading: Reading
) -> Node:
    """Read `switch: $x` with `cases:` and `default:` beside it, or with ports and `children:`."""
    if isinstance(value, Entries) and not companions:
        return _plain_switch(key, value, reading)
    beside = {name.text: raw for name, raw in companions}
    for name in COMPANIONS[SWITCH]:
        if name not in beside:
            message, hint = f"`{SWITCH}` without `{name}:`", f"write `{name}:` beside it"
            return reading.broken("missing-child", key.place, message, hint)
    cases = beside["cases"]
    fewest, most = min(SWITCHES), max(SWITCHES)
    if not isinstance(cases, Entries) or not fewest <= len(cases.entries) <= most:
        message = f"`cases` is a mapping of {fewest} to {most} values to nodes"
        hint = "such as `cases: {red: stop, green: go}`; `if` decides between two"
        return reading.broken("wrong-value", cases.place, message, hint)
    drop_duplicates(cases, reading.problems)
    spec = SWITCHES.get(len(cases.entries))
    if spec is None:  # there was a duplicate
        return Node(BROKEN, key.place)
    node = Node(spec.type, key.place)
    read_port(node, ("variable", value.place), value, spec, reading.problems)
    for number, (case, raw) in enumerate(cases.entries, start=1):
        read_port(node, (f"case_{number}", case.place), case, spec, reading.problems)
        reading.later(raw, node.children.append)
    reading.later(beside["default"], node.children.append)
    return node


def _plain_switch(key: Scalar, value: Entries, reading: Reading) -> Node:
    below = next((raw for name, raw in value.entries if name.text == "children"), None)
    count = len(below.items) - 1 if isinstance(below, Items) else 0
    if count not in SWITCHES:
        message = f"`{SWITCH}` takes a value, with `cases:` and `default:` beside it"
        hint = "such as `switch: $colour`"
        return reading.broken("missing-child", value.place, message, hint)
    node = Node(SWITCHES[count].type, key.place)
    read_control(node, value, SWITCHES[count], reading)
    return node

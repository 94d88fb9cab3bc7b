"""Keys beside a node's own: decorators around it, conditions, its name and note."""

from __future__ import annotations

from momantu_bt.formats.names import nearest
from momantu_bt.formats.yaml.values import Entries, Raw, Scalar
from momantu_bt.tree.catalogue import FORCED, MODIFIERS, NODES, PRE_CONDITIONS, SPELLED, NodeSpec
from momantu_bt.tree.catalogue.nodes import DOCTOR, why_broken
from momantu_bt.tree.files.port_values import words
from momantu_bt.tree.files.yaml.kept import is_kept, read_kept
from momantu_bt.tree.files.yaml.ports import is_empty, read_port, read_ports
from momantu_bt.tree.files.yaml.reading import Reading, said
from momantu_bt.tree.files.yaml.scripts import read_script
from momantu_bt.tree.model import BROKEN, Node
from momantu_bt.tree.problems import Problems


def near_modifier(name: str) -> str | None:
    """The modifier that a wrong name probably means."""
    return nearest(name, MODIFIERS)


def modified(node: Node, modifiers: list[tuple[Scalar, Raw]], reading: Reading) -> Node:
    """The node with its modifiers, inside the modifiers that are decorators."""
    outer = node
    read_kept(node, modifiers, reading)
    for key, value in modifiers:
        kind = MODIFIERS.get(key.text)
        if is_kept(key):
            continue
        if kind == "decorator":
            outer = _decorated(outer, key, value, reading.problems)
        elif kind == "condition":
            _condition(node, key, value, reading.problems)
        elif kind == "key":
            _node_entry(node, key, value, reading.problems)
        else:
            _report_unknown(node, key, reading)
    return outer


def _report_unknown(node: Node, key: Scalar, reading: Reading) -> None:
    broken = why_broken(key.text)
    if broken is not None:
        reading.error("broken-plugin", key.place, broken, DOCTOR)
        return
    near = near_modifier(key.text)
    if near is not None:
        hint = f"did you mean {near}?"
    elif reading.is_known(key.text) or node.type == BROKEN:
        hint = "begin each node with `- `"
    else:
        hint = f"begin it with `- ` if it is a node, indent it if it is a port of {said(node)}"
    reading.error("unknown-modifier", key.place, f"no modifier is called {key.text!r}", hint)


def _node_entry(node: Node, key: Scalar, value: Raw, problems: Problems) -> None:
    node.condition_places[key.text] = value.place
    if key.text == "disabled":
        node.disabled = _flag(value, problems)
    else:
        setattr(node, key.text, words(value, problems, f"`{key.text}`") or None)


def _flag(value: Raw, problems: Problems) -> bool:
    """True or false; false if a problem was reported."""
    if isinstance(value, Scalar) and isinstance(value.value, bool):
        return value.value
    text = value.text if isinstance(value, Scalar) else ""
    near = {"yes": "true", "no": "false", "on": "true", "off": "false"}.get(text.lower())
    hint = f"did you mean {near}?" if near else "write true or false"
    problems.error("wrong-value", value.place, "true or false is expected here", hint)
    return False


def _condition(node: Node, key: Scalar, value: Raw, problems: Problems) -> None:
    script = read_script(value, problems, asked=key.text in PRE_CONDITIONS)
    if script is not None:
        node.conditions[key.text] = script
        node.condition_places[key.text] = value.place


def _decorated(inner: Node, key: Scalar, value: Raw, problems: Problems) -> Node:
    spec = _decorator_spec(key, value, problems)
    if spec is None:
        return inner
    node = Node(spec.type, key.place, written_as_modifier=True, children=[inner])
    if key.text == "force":
        return node
    if isinstance(value, Entries):
        read_ports(node, value, spec, problems)
    elif spec.first is not None and not is_empty(value):
        read_port(node, (spec.first, key.place), value, spec, problems)
    elif not is_empty(value) and not (isinstance(value, Scalar) and value.value is True):
        problems.error("wrong-value", value.place, f"`{key.text}` takes no value", "remove it")
    return node


def _decorator_spec(key: Scalar, value: Raw, problems: Problems) -> NodeSpec | None:
    if key.text != "force":
        return SPELLED[key.text]
    text = value.text if isinstance(value, Scalar) else ""
    if text in FORCED:
        return NODES[FORCED[text]]
    near = nearest(text, FORCED)
    hint = f"did you mean {near}?" if near else "write success or failure"
    problems.error("wrong-value", value.place, "`force` is success or failure", hint)
    return None

"""Values of ports in words, for those who print trees and for nodes that say how they print."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from momantu_bt.tree.model import Literal, Node, PortValue, Reference, Scope, Template
from momantu_bt.tree.script import ScriptSyntaxError, yaml_spelling

_UNKNOWN = Literal("?")


def value_text(value: PortValue) -> str:
    """A port's value as a tree file writes it."""
    if isinstance(value, Reference):
        return "$" + _key(value)
    if isinstance(value, Template):
        parts = (p if isinstance(p, str) else f"${{{_key(p)}}}" for p in value.parts)
        return '"' + "".join(parts) + '"'
    return _plain(value.value)


def port_text(node: Node, port: str) -> str:
    """The value of one port; `?` if the tree does not give it."""
    return value_text(node.ports.get(port, _UNKNOWN))


def ports_in_words(node: Node, ports: Mapping[str, PortValue]) -> list[str]:
    """Some of a node's ports, each with its value."""
    return [
        value_text(value) if _is_bare(node, name) else f"{name} {value_text(value)}"
        for name, value in ports.items()
    ]


def script_text(script: str) -> str:
    """A script as a YAML file writes it."""
    try:
        return yaml_spelling(script)
    except ScriptSyntaxError:
        return script


def script_ports(node: Node) -> list[str]:
    """The scripts that a node's ports hold."""
    return [script_text(str(v.value)) for v in node.ports.values() if isinstance(v, Literal)]


def tries_text(node: Node, port: str, word: str = "try", words: str = "tries") -> str:
    """A count: `1 try`, `3 tries`, `tries without end`."""
    value = node.ports.get(port, _UNKNOWN)
    if value == Literal(1):
        return f"1 {word}"
    if value == Literal(-1):
        return f"{words} without end"
    return f"{value_text(value)} {words}"


def duration_text(node: Node) -> str:
    """The time of a node with `time_ports`."""
    if "msec" in node.ports:
        return f"{value_text(node.ports['msec'])} ms"
    value = node.ports.get("duration", _UNKNOWN)
    shown = value_text(value)
    bare = isinstance(value, Literal) and isinstance(value.value, int | float)
    return f"{shown} s" if bare else shown


def _is_bare(node: Node, port: str) -> bool:
    """Whether the value was written without the port's name (`dock: bay_a`)."""
    place = node.port_places.get(port)
    return place is None or node.port_name_places.get(port) == place


def _key(reference: Reference) -> str:
    at = "@" if reference.scope is Scope.ROOT else ""
    return at + ".".join((reference.key, *reference.fields))


def _plain(value: Any) -> str:
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k}: {_plain(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_plain(item) for item in value) + "]"
    return str(value)

"""`models:` in YAML: what an XML file says of nodes for an editor's palette, kept as it is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from momantu_bt.formats.names import valid_names
from momantu_bt.formats.yaml.values import Entries, Items, Raw, Scalar, plain_value
from momantu_bt.formats.yaml.writer import scalar
from momantu_bt.tree.files.yaml.lines import above
from momantu_bt.tree.model import Literal, NodeModel, PortDeclaration
from momantu_bt.tree.problems import Problems

KINDS = ("Action", "Condition", "Control", "Decorator")
"""Kinds of nodes in a palette. The kind is the key that names a model's node."""
_DIRECTIONS = ("in", "out", "inout")
_HINT = "such as `- {Action: Name, ports: [{in: goal, type: Pose}]}`"


def read_models(raw: Raw, problems: Problems) -> tuple[NodeModel, ...]:
    """The models of a file. Models that are written wrongly are reported and left out."""
    if not isinstance(raw, Items):
        problems.error("wrong-value", raw.place, "`models` is a list of nodes", _HINT)
        return ()
    found = (_model(item, problems) for item in raw.items)
    return tuple(model for model in found if model is not None)


def _model(raw: Raw, problems: Problems) -> NodeModel | None:
    having = _fields(raw, (*KINDS, "editable", "ports", "metadata"), problems)
    kind = next((kind for kind in KINDS if kind in having), None)
    if kind is None or not isinstance(having[kind], Scalar):
        problems.error("wrong-value", raw.place, "a model names its node", _HINT)
        return None
    editable = plain_value(having["editable"]) if "editable" in having else None
    metadata = plain_value(having["metadata"]) if "metadata" in having else []
    ports = having.get("ports")
    listed = ports.items if isinstance(ports, Items) else []
    declared = tuple(port for each in listed if (port := _port(each, problems)) is not None)
    if not _is_right(editable, metadata) or not isinstance(ports, Items | None):
        problems.error("wrong-value", raw.place, "this is not a model of a node", _HINT)
        return None
    pairs = tuple((str(name), str(value)) for name, value in metadata)
    return NodeModel(_text(having[kind]), kind, declared, editable, pairs)


def _is_right(editable: Any, metadata: Any) -> bool:
    pairs = isinstance(metadata, list) and all(
        isinstance(pair, list) and len(pair) == 2 for pair in metadata
    )
    return pairs and (editable is None or isinstance(editable, bool))


def _port(raw: Raw, problems: Problems) -> PortDeclaration | None:
    having = _fields(raw, (*_DIRECTIONS, "type", "default", "doc"), problems)
    direction = next((name for name in _DIRECTIONS if name in having), None)
    if direction is None:
        problems.error("wrong-value", raw.place, "a port of a model has a direction", _HINT)
        return None
    default = Literal(_text(having["default"])) if "default" in having else None
    type_name, doc = (_text(having[key]) if key in having else "" for key in ("type", "doc"))
    name, place = _text(having[direction]), having[direction].place
    return PortDeclaration(name, direction, type_name, place, default, doc)


def _fields(raw: Raw, known: Sequence[str], problems: Problems) -> dict[str, Raw]:
    entries = raw.entries if isinstance(raw, Entries) else []
    for key, _ in entries:
        if key.text not in known:
            hint = valid_names(key.text, known, "keys")
            problems.error("unknown-key", key.place, f"a model has no {key.text!r}", hint)
    return {key.text: value for key, value in entries if key.text in known}


def _text(raw: Raw) -> str:
    return raw.text if isinstance(raw, Scalar) else ""


def write_models(models: Sequence[NodeModel]) -> list[str]:
    """The lines under `models:`."""
    lines: list[str] = []
    for model in models:
        lines.append(f"  - {model.kind}: {scalar(model.name)}")
        if model.editable is not None:
            lines.append(f"    editable: {'true' if model.editable else 'false'}")
        if model.ports:
            lines.append("    ports:")
        for port in model.ports:
            lines += above(port.comments, " " * 6, every=True)
            lines.append(f"      - {{{_port_text(port)}}}")
        if model.metadata:
            pairs = (f"[{_flow(name)}, {_flow(value)}]" for name, value in model.metadata)
            lines.append(f"    metadata: [{', '.join(pairs)}]")
    return lines


def _port_text(port: PortDeclaration) -> str:
    words = [f"{port.direction}: {_flow(port.name)}"]
    words += [f"type: {_flow(port.type_name)}"] if port.type_name else []
    if isinstance(port.default, Literal):
        words.append(f"default: {_flow(str(port.default.value))}")
    return ", ".join([*words, *([f"doc: {_flow(port.doc)}"] if port.doc else [])])


def _flow(text: str) -> str:
    return scalar(text, flow=True)

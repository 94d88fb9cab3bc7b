"""The JSON Schema of a port's value in a tree file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

from momantu_bt.formats.units import units_of
from momantu_bt.plugins import installed_names
from momantu_bt.skill import MISSING, Port
from momantu_bt.tree.files.yaml.words import BTCPP
from momantu_bt.values import kinds
from momantu_bt.values.kinds import CodeText, ScriptText, ValueKind, ValueType, kind_of, parts_of
from momantu_bt.values.types import label

Schema: TypeAlias = dict[str, Any]

_KEPT: Schema = {"type": "object", "properties": {BTCPP: {"type": "string"}}, "required": [BTCPP]}
SCRIPT: Schema = {
    "anyOf": [
        {"type": ["string", "boolean", "number"]},
        {**_KEPT, "additionalProperties": False, "description": "in BehaviorTree.CPP's spelling"},
    ]
}
"""A condition or script."""

Names: TypeAlias = Mapping[str, Sequence[str]]
"""Valid values by kind: "place", "surface", "named_pose", "tag"."""

_DEEPEST = 4
"""The most levels of fields within fields. Deeper fields may have any value."""

WIRE: Schema = {"type": "string", "pattern": r"^\$", "description": "a key"}


def value_schema(port: Port, names: Names) -> Schema:
    """The schema of a port's value: a key, or a value of its type."""
    found: Schema = {"description": _about(port)}
    if port.direction == "out":
        return found | {"type": "string", "pattern": r"^\$"}
    if port.type is ScriptText:
        return found | SCRIPT
    known = names.get(port.names or "")
    if port.names is not None and "." in port.names:
        known = installed_names(port.names)
    literal = {"enum": list(known)} if known else _of(kind_of(port.type), port.unit, _DEEPEST)
    if port.default is not MISSING and isinstance(port.default, bool | int | float | str):
        found["default"] = port.default
    return found | {"anyOf": [literal, WIRE]}


def _about(port: Port) -> str:
    kind = label(port.type) + (f" in {port.unit}" if port.unit else "")
    kind += f", {port.bounds}" if port.bounds else ""
    return f"{port.doc} ({kind})" if port.doc else kind


def _of(kind: ValueKind, unit: str | None, depth: int) -> Schema:
    match kind:
        case kinds.Either():
            return {"anyOf": [_of(option, unit, depth) for option in _none_last(kind)]}
        case kinds.Choice():
            return {"enum": list(kind.values)}
        case kinds.Enumeration():
            return {"enum": [item.value for item in kind.type]}
        case kinds.Items():
            return _items(kind, unit, depth)
        case kinds.Fixed():
            each = [_of(item, unit, depth - 1) for item in kind.items]
            count = len(each)
            return {"type": "array", "prefixItems": each, "minItems": count, "maxItems": count}
        case kinds.Table():
            items = _of(kind.item, unit, depth - 1)
            return {"type": "object"} | ({"additionalProperties": items} if items else {})
        case kinds.Nothing():
            return {"type": "null"}
        case kinds.Truth():
            return {"type": "boolean"}
        case kinds.Number():
            return _number(kind.type, unit)
        case kinds.Text():
            return _text(kind.type)
        case kinds.Record() if depth > 0:
            return _fields(kind, depth)
        case _:
            return {}


def _none_last(kind: kinds.Either) -> list[ValueKind]:
    return sorted(kind.options, key=lambda option: isinstance(option, kinds.Nothing))


def _text(type_: type[str]) -> Schema:
    if type_ is CodeText:
        return {"type": "string", "pattern": r"^[A-Z]"}
    return {"type": "string"}


def _number(type_: ValueType, unit: str | None) -> Schema:
    number = {"type": "integer" if type_ is int else "number"}
    if type_ is int and unit is None:
        return number
    units = f", such as 3 {units_of(unit)[0]}" if unit and units_of(unit) else ""
    measured = {"type": "string", "pattern": r"^[-+.\d]", "description": f"with a unit{units}"}
    return {"anyOf": [number, measured]}


def _items(kind: kinds.Items, unit: str | None, depth: int) -> Schema:
    items = _of(kind.item, unit, depth - 1)
    return {"type": "array"} | ({"items": items} if items else {})


def _fields(kind: kinds.Record, depth: int) -> Schema:
    parts = parts_of(kind.type)
    return {
        "type": "object",
        "properties": {part.name: _of(part.kind, part.unit, depth - 1) for part in parts},
        "required": [part.name for part in parts if part.required],
        "additionalProperties": False,
    }

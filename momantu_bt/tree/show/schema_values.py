"""The JSON Schema of a port's value in a tree file."""

from __future__ import annotations

import dataclasses
import typing
from collections.abc import Mapping, Sequence
from enum import Enum
from typing import Any, Literal, TypeAlias, get_args

from momantu_bt.formats.units import units_of
from momantu_bt.skill import MISSING, Port
from momantu_bt.tree.catalogue import CodeText, ScriptText
from momantu_bt.tree.files.yaml.words import BTCPP
from momantu_bt.tree.types import ValueType, is_union, label, origin, without_none

_KEPT = {"type": "object", "properties": {BTCPP: {"type": "string"}}, "required": [BTCPP]}
SCRIPT: dict[str, Any] = {
    "anyOf": [
        {"type": ["string", "boolean", "number"]},
        {**_KEPT, "additionalProperties": False, "description": "in BehaviorTree.CPP's spelling"},
    ]
}
"""A condition or script."""

Names: TypeAlias = Mapping[str, Sequence[str]]
"""Valid values by kind: "place", "surface", "named_pose"."""

_DEEPEST = 4
"""Fields within fields; deeper ones are left open."""

WIRE: dict[str, Any] = {"type": "string", "pattern": r"^\$", "description": "a key"}


def value_schema(port: Port, names: Names) -> dict[str, Any]:
    """What a port takes: a key, or a value of its type."""
    found: dict[str, Any] = {"description": _about(port)}
    if port.direction == "out":
        return found | {"type": "string", "pattern": r"^\$"}
    if port.type is ScriptText:
        return found | SCRIPT
    known = names.get(port.names or "")
    literal = {"enum": list(known)} if known else _of(port.type, port.unit, _DEEPEST)
    if port.default is not MISSING and isinstance(port.default, bool | int | float | str):
        found["default"] = port.default
    return found | {"anyOf": [literal, WIRE]}


def _about(port: Port) -> str:
    kind = label(port.type) + (f" in {port.unit}" if port.unit else "")
    kind += f", {port.bounds}" if port.bounds else ""
    return f"{port.doc} ({kind})" if port.doc else kind


def _of(type_: ValueType, unit: str | None, depth: int) -> dict[str, Any]:
    if is_union(type_):
        choices = [_of(choice, unit, depth) for choice in without_none(type_)]
        if type(None) in get_args(type_):
            choices.append({"type": "null"})
        return {"anyOf": choices}
    if origin(type_) is Literal:
        return {"enum": list(get_args(type_))}
    if isinstance(type_, type) and issubclass(type_, Enum):
        return {"enum": [item.value for item in type_]}
    if type_ is tuple or origin(type_) is tuple:
        return _list(get_args(type_), unit, depth)
    if type_ is bool:
        return {"type": "boolean"}
    if type_ is int or type_ is float:
        return _number(type_, unit)
    if isinstance(type_, type) and issubclass(type_, str):
        return _text(type_)
    if dataclasses.is_dataclass(type_) and depth > 0:
        return _fields(type_, depth)
    return {}


def _text(type_: type[str]) -> dict[str, Any]:
    if type_ is CodeText:
        return {"type": "string", "pattern": r"^[A-Z]"}
    return {"type": "string"}


def _number(type_: ValueType, unit: str | None) -> dict[str, Any]:
    number = {"type": "integer" if type_ is int else "number"}
    if type_ is int and unit is None:
        return number
    units = f", such as 3 {units_of(unit)[0]}" if unit and units_of(unit) else ""
    measured = {"type": "string", "pattern": r"^[-+.\d]", "description": f"with a unit{units}"}
    return {"anyOf": [number, measured]}


def _list(items: tuple[Any, ...], unit: str | None, depth: int) -> dict[str, Any]:
    if not items:
        return {"type": "array"}
    if len(items) == 2 and items[1] is Ellipsis:
        return {"type": "array", "items": _of(items[0], unit, depth - 1)}
    each = [_of(item, unit, depth - 1) for item in items]
    return {"type": "array", "prefixItems": each, "minItems": len(each), "maxItems": len(each)}


def _fields(type_: Any, depth: int) -> dict[str, Any]:
    hints = typing.get_type_hints(type_)
    having = [field for field in dataclasses.fields(type_) if field.init]
    required = [
        field.name
        for field in having
        if field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING
    ]
    return {
        "type": "object",
        "properties": {
            field.name: _of(hints[field.name], field.metadata.get("unit"), depth - 1)
            for field in having
        },
        "required": required,
        "additionalProperties": False,
    }

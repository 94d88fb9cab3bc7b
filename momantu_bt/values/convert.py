"""Converting values of tree files to the types of ports.

The checker converts every literal; the engine converts every value that an input reads. So
`convert` returns a value that already has the right type unchanged.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np

from momantu_bt.formats.names import nearest
from momantu_bt.formats.units import UnitError, quantity, units_of
from momantu_bt.skill import Port
from momantu_bt.values import kinds
from momantu_bt.values.contents import freeze, retuple
from momantu_bt.values.kinds import ValueKind, kind_of, parts_of, without_none
from momantu_bt.values.scalars import to_bool, to_choice, to_enum, to_number, to_text
from momantu_bt.values.types import label
from momantu_bt.values.words import ConversionError, in_words, shown, unfit

_BOOLS = {"true": True, "1": True, "false": False, "0": False}
"""The texts that BehaviorTree.CPP reads as a bool."""


def convert(value: Any, port: Port) -> Any:
    """Convert a value to the port's type, immutable; a value that already fits stays unchanged.

    Numbers with units become SI numbers, mappings the port's dataclass, lists tuples.

    Raises:
        ConversionError: the value does not fit, or a number is out of the port's bounds.
    """
    found = _convert(value, kind_of(port.type), port.unit)
    if port.bounded:
        _check_bounds(value, found, port)
    return found


def _check_bounds(value: Any, found: Any, port: Port) -> None:
    """Check a number, or each number of a list; items that are not numbers have no bounds."""
    written = value if isinstance(value, list | tuple) else (value,)
    for number, raw in zip(found if isinstance(found, tuple) else (found,), written, strict=False):
        if not isinstance(number, int | float) or port.allows(number):
            continue
        unit = f" {port.unit}" if port.unit is not None else ""
        said = raw if isinstance(raw, str) else f"{shown(number)}{unit}"
        message = f"{said} is out of range; expected {port.bounds}{unit}"
        raise ConversionError(message + _unit_meant(raw, port))


def _unit_meant(value: Any, port: Port) -> str:
    """A hint at the units with which a bare number would be within the bounds; perhaps empty."""
    if port.unit is None or isinstance(value, str) or not isinstance(value, int | float):
        return ""
    said = shown(value)
    fitting = []
    for unit in reversed(units_of(port.unit)):
        found = quantity(f"{value!r} {unit}")
        if found is not None and port.allows(found.value):
            fitting.append(f"{said} {unit}")
    return f"; did you mean {' or '.join(fitting)}?" if fitting else ""


def natural(value: Any) -> Any:
    """Convert a value without a port: quantities become SI numbers, containers immutable.

    A text that only looks like a quantity (`5 apples`) stays a text.
    """
    if isinstance(value, str):
        try:
            found = quantity(value)
        except UnitError:
            return value
        return value if found is None else found.value
    if isinstance(value, Mapping):
        return MappingProxyType({str(key): natural(item) for key, item in value.items()})
    if isinstance(value, list | tuple):
        return tuple(natural(item) for item in value)
    return freeze(value)


def _convert(value: Any, kind: ValueKind, unit: str | None) -> Any:
    match kind:
        case kinds.Number():
            return to_number(value, kind.type, unit)
        case kinds.Text():
            return to_text(value, kind.type)
        case kinds.Truth():
            return to_bool(value)
        case kinds.Record():
            return _to_dataclass(value, kind, unit)
        case kinds.Either():
            return _to_either(value, kind, unit)
        case kinds.Anything() | kinds.Unknown():
            return natural(value)
        case kinds.Choice():
            return to_choice(value, kind.values)
        case kinds.Enumeration():
            return to_enum(value, kind.type)
        case kinds.Items():
            return _to_items(value, kind, unit)
        case kinds.Fixed():
            return _to_fixed(value, kind, unit)
        case kinds.QueueOf():
            return _to_queue(value, kind)
        case kinds.Table():
            return _to_table(value, kind, unit)
        case kinds.Array():
            return _to_array(value)
        case kinds.Instance() | kinds.Nothing():
            if isinstance(value, kind.type):
                return value
            raise unfit(value, kind.type, unit)


def _to_either(value: Any, kind: kinds.Either, unit: str | None) -> Any:
    options = without_none(kind)
    if value is None and len(options) < len(kind.options):
        return None
    if any(type(value) is option.type for option in options if not isinstance(option, _HOLDERS)):
        return value
    errors: list[ConversionError] = []
    for option in sorted(options, key=lambda option: option.type is str):
        try:
            return _convert(value, option, unit)
        except ConversionError as error:
            errors.append(error)
    if len(errors) == 1:
        raise errors[0]
    raise unfit(value, kind.type, unit)


_HOLDERS = (kinds.Items, kinds.Table)
"""Kinds with parts: a value of the right class may still have parts that do not fit."""


_WORDS = (kinds.Number, kinds.Text, kinds.Truth)
"""Kinds of which a text can have several, separated by `;`."""


def _to_items(value: Any, kind: kinds.Items, unit: str | None) -> tuple[Any, ...]:
    found = _list(value, kind)
    return _each(found, (kind.item,) * len(found), unit)


def _to_fixed(value: Any, kind: kinds.Fixed, unit: str | None) -> tuple[Any, ...]:
    found = _list(value, kind)
    if len(kind.items) != len(found):
        raise ConversionError(f"a list of {len(found)}; expected {label(kind.type)}")
    return _each(found, kind.items, unit)


def _list(value: Any, kind: ValueKind) -> list[Any] | tuple[Any, ...]:
    if isinstance(value, list | tuple):
        return value
    items = kind.items if isinstance(kind, kinds.Fixed) else (getattr(kind, "item", None),)
    if isinstance(value, str) and ";" in value and isinstance(items[0], _WORDS):
        # as BehaviorTree.CPP writes lists
        return [_item(text, items[0]) for text in value.removesuffix(";").split(";")]
    raise ConversionError(f"{shown(value)} is not a list; expected {label(kind.type)}: [a, b]")


def _each(
    value: list[Any] | tuple[Any, ...], kinds: tuple[ValueKind, ...], unit: str | None
) -> tuple[Any, ...]:
    """Convert each item to its kind; returns the same tuple if nothing has changed."""
    items = []
    for index, (item, kind) in enumerate(zip(value, kinds, strict=True)):
        try:
            items.append(_convert(item, kind, unit))
        except ConversionError as error:
            raise ConversionError(f"item {index + 1} of the list: {error}") from None
    return retuple(value, items)


def _to_queue(value: Any, kind: kinds.QueueOf) -> tuple[Any, ...]:
    """Convert a list, one value, or a text that is split at each `;` as in BehaviorTree.CPP."""
    if isinstance(value, str):
        texts = value.removesuffix(";").split(";") if value else []
        value = [_item(text, kind.item) for text in texts]
    elif isinstance(value, bool | int | float):
        value = [in_words(value) if isinstance(kind.item, kinds.Text) else value]
    return _to_items(value, kinds.Items(kind.type, kind.item), None)


def _item(text: str, kind: ValueKind) -> Any:
    """Convert one value of a text with several."""
    if isinstance(kind, kinds.Text):
        return text
    text = text.strip()
    return _BOOLS.get(text.lower(), text) if isinstance(kind, kinds.Truth) else text


def _to_table(value: Any, kind: kinds.Table, unit: str | None) -> Mapping[Any, Any]:
    if not isinstance(value, Mapping):
        raise unfit(value, kind.type, unit)
    found = {}
    for key, item in value.items():
        try:
            found[_convert(key, kind.key, None)] = _convert(item, kind.item, unit)
        except ConversionError as error:
            raise ConversionError(f"key {key!r}: {error}") from None
    return MappingProxyType(found)


def _to_array(value: Any) -> Any:
    """Convert a list of numbers, with or without units, or a list of such lists."""
    if isinstance(value, np.ndarray):
        return freeze(value)
    try:
        array = np.array(natural(value), dtype=np.float64)
    except (TypeError, ValueError):
        array = np.array(math.nan)
    if array.ndim == 0 or not np.isfinite(array).all():
        raise ConversionError(f"{shown(value)} does not fit; expected a list of numbers")
    array.flags.writeable = False
    return array


def _to_dataclass(value: Any, kind: kinds.Record, unit: str | None) -> Any:
    if isinstance(value, kind.type):
        return value
    if isinstance(value, str) and hasattr(kind.type, "from_text"):
        return _from_text(value, kind)
    if not isinstance(value, Mapping):
        raise unfit(value, kind.type, unit)
    parts = parts_of(kind.type)
    _refuse_unknown_fields(value, parts, kind)
    arguments: dict[str, Any] = {}
    for part in parts:
        if part.name in value:
            try:
                arguments[part.name] = _convert(value[part.name], part.kind, part.unit)
                _check_bounds(value[part.name], arguments[part.name], _port_of(part))
            except ConversionError as error:
                raise ConversionError(f"field {part.name!r}: {error}") from None
        elif part.required:
            raise ConversionError(f"{label(kind.type)} needs the field {part.name!r}")
    try:
        return kind.type(**arguments)
    except ValueError as error:
        raise ConversionError(f"{label(kind.type)}: {error}") from None


@cache
def _port_of(part: kinds.Part) -> Port:
    """A port with the bounds of a field."""
    return Port(
        part.name, "in", part.kind.type, "", unit=part.unit, least=part.least, most=part.most
    )


def _from_text(value: str, kind: kinds.Record) -> Any:
    """Convert a text as the dataclass itself reads it, such as `Pose2D.from_text`."""
    try:
        return kind.type.from_text(value)
    except ValueError as error:
        raise ConversionError(str(error)) from None


def _refuse_unknown_fields(
    value: Mapping[str, Any], parts: tuple[kinds.Part, ...], kind: kinds.Record
) -> None:
    names = [part.name for part in parts]
    for key in value:
        if key not in names:
            near = nearest(str(key), names)
            hint = f", did you mean {near!r}?" if near else "."
            raise ConversionError(
                f"{label(kind.type)} has no field {key!r}{hint} Fields: {', '.join(names)}"
            )

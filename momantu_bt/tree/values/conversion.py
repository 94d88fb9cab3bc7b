"""Values as tree files write them, turned into what ports take.

Used twice: by the checker on every literal, and by the engine on everything that reaches an
input, so `convert` leaves alone what is of the right type already.
"""

from __future__ import annotations

import dataclasses
import inspect
import math
from collections.abc import Mapping, Sequence
from enum import Enum
from types import MappingProxyType
from typing import Any, Literal, get_args, get_type_hints

import numpy as np

from momantu_bt.formats.names import nearest
from momantu_bt.formats.units import UnitError, quantity
from momantu_bt.skill import MISSING, Port
from momantu_bt.tree import model
from momantu_bt.tree.catalogue import Queue
from momantu_bt.tree.script.nodes import part
from momantu_bt.tree.types import ValueType, is_union, label, members, origin, parse_type
from momantu_bt.tree.values.scalars import to_bool, to_choice, to_enum, to_number, to_text
from momantu_bt.tree.values.words import ConversionError, in_words, shown, unfit

__all__ = ["ConversionError", "convert", "natural", "part", "port_of", "render"]

_BOOLS = {"true": True, "1": True, "false": False, "0": False}
"""What BehaviorTree.CPP takes for a bool within a text."""


def convert(value: Any, port: Port) -> Any:
    """A value as the port's type; a value that has it already is returned as it is.

    Numbers with units become SI numbers, mappings become the port's dataclass, lists tuples.

    Raises:
        ConversionError: it does not fit, or a number is out of the port's bounds.
    """
    found = _convert(value, port.type, port.unit)
    if port.bounded:
        _check_bounds(value, found, port)
    return found


def _check_bounds(value: Any, found: Any, port: Port) -> None:
    """Each number of a list by itself; what is no number has no bounds."""
    for number in found if isinstance(found, tuple) else (found,):
        if isinstance(number, int | float) and not port.allows(number):
            said = value if isinstance(value, str) else shown(number)
            unit = f" {port.unit}" if port.unit is not None else ""
            raise ConversionError(f"{said} is out of range; expected {port.bounds}{unit}")


def natural(value: Any) -> Any:
    """A value that no port types yet: quantities become SI numbers, containers immutable.

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
    return value


def port_of(declaration: model.PortDeclaration) -> Port:
    """A subtree's input or output as a port.

    Raises:
        KeyError: its type has no such name.
    """
    default = declaration.default
    return Port(
        declaration.name,
        declaration.direction,
        parse_type(declaration.type_name),
        declaration.doc,
        default.value
        if isinstance(default, model.Literal)
        else MISSING
        if default is None
        else None,
    )


def render(parts: Sequence[Any]) -> str:
    """Text from its parts, references replaced by their values."""
    return "".join(piece if isinstance(piece, str) else in_words(piece) for piece in parts)


def _convert(value: Any, type_: ValueType, unit: str | None) -> Any:
    if type_ in (object, Any):
        return natural(value)
    if is_union(type_):
        return _to_union(value, type_, unit)
    if origin(type_) is Literal:
        return to_choice(value, get_args(type_))
    if origin(type_) is Queue:
        return _to_queue(value, get_args(type_)[0])
    if type_ is tuple or origin(type_) is tuple:
        return _to_tuple(value, type_, unit)
    if origin(type_) is np.ndarray:
        return _to_array(value)
    if type_ is bool:
        return to_bool(value)
    if type_ is int or type_ is float:
        return to_number(value, type_, unit)
    if isinstance(type_, type) and issubclass(type_, Enum):
        return to_enum(value, type_)
    if isinstance(type_, type) and issubclass(type_, str):
        return to_text(value, type_)
    if isinstance(type_, type) and isinstance(value, type_):
        return value
    if dataclasses.is_dataclass(type_) and isinstance(value, Mapping):
        return _to_dataclass(value, type_)
    raise unfit(value, type_, unit)


def _to_union(value: Any, type_: ValueType, unit: str | None) -> Any:
    choices = members(type_)
    if value is None and type(None) in choices:
        return None
    choices = tuple(choice for choice in choices if choice is not type(None))
    if type(value) in choices:
        return value
    errors: list[ConversionError] = []
    for choice in sorted(choices, key=lambda choice: choice is str):
        try:
            return _convert(value, choice, unit)
        except ConversionError as error:
            errors.append(error)
    if len(errors) == 1:
        raise errors[0]
    raise unfit(value, type_, unit)


def _to_tuple(value: Any, type_: ValueType, unit: str | None) -> Any:
    if not isinstance(value, list | tuple):
        raise ConversionError(f"{shown(value)} is not a list; expected {label(type_)}: [a, b]")
    inner = get_args(type_)
    if not inner:
        return tuple(natural(item) for item in value)
    if len(inner) == 2 and inner[1] is Ellipsis:
        inner = (inner[0],) * len(value)
    if len(inner) != len(value):
        raise ConversionError(f"a list of {len(value)}; expected {label(type_)}")
    items = []
    for index, (item, item_type) in enumerate(zip(value, inner, strict=True)):
        try:
            items.append(_convert(item, item_type, unit))
        except ConversionError as error:
            raise ConversionError(f"item {index + 1} of the list: {error}") from None
    if isinstance(value, tuple) and all(a is b for a, b in zip(items, value, strict=True)):
        return value
    return tuple(items)


def _to_queue(value: Any, item: type) -> tuple[Any, ...]:
    """A list; or a text, split at each `;` as BehaviorTree.CPP does; or one value alone."""
    if isinstance(value, str):
        parts = value.removesuffix(";").split(";") if value else []
        value = [_item(part, item) for part in parts]
    elif isinstance(value, bool | int | float):
        value = [in_words(value) if item is str else value]
    found: tuple[Any, ...] = _to_tuple(value, tuple[item, ...], None)  # type: ignore[valid-type]
    return found


def _item(text: str, type_: type) -> Any:
    """One of the values in a text of several, as its type would be written alone."""
    if type_ is str:
        return text
    text = text.strip()
    return _BOOLS.get(text.lower(), text) if type_ is bool else text


def _to_array(value: Any) -> Any:
    """A list of numbers, or of such lists, each perhaps with a unit."""
    if isinstance(value, np.ndarray):
        return value
    try:
        array = np.array(natural(value), dtype=np.float64)
    except (TypeError, ValueError):
        array = np.array(math.nan)
    if array.ndim == 0 or not np.isfinite(array).all():
        raise ConversionError(f"{shown(value)} does not fit; expected a list of numbers")
    array.flags.writeable = False
    return array


def _to_dataclass(value: Mapping[str, Any], type_: Any) -> Any:
    hints = get_type_hints(type_)
    having = {field.name: field for field in dataclasses.fields(type_) if field.init}
    for key in value:
        if key not in having:
            near = nearest(str(key), having)
            hint = f", did you mean {near!r}?" if near else "."
            raise ConversionError(
                f"{label(type_)} has no field {key!r}{hint} Fields: {', '.join(having)}"
            )
    arguments: dict[str, Any] = {}
    made_of = inspect.signature(type_).parameters
    for name, field in having.items():
        if name in value:
            try:
                arguments[name] = _convert(value[name], hints[name], field.metadata.get("unit"))
            except ConversionError as error:
                raise ConversionError(f"field {name!r}: {error}") from None
        elif made_of[name].default is inspect.Parameter.empty:
            raise ConversionError(f"{label(type_)} needs the field {name!r}")
    try:
        return type_(**arguments)
    except ValueError as error:
        raise ConversionError(f"{label(type_)}: {error}") from None

"""Values as tree files write them, turned into what ports take.

Used twice: by the checker on every literal, and by the engine on everything that reaches an
input, so `convert` leaves alone what is of the right type already.
"""

from __future__ import annotations

import dataclasses
import difflib
import inspect
import math
import re
from collections.abc import Mapping, Sequence
from enum import Enum
from types import MappingProxyType
from typing import Any, Literal, get_args, get_type_hints

import numpy as np

from momantu_bt.skill import MISSING, Port
from momantu_bt.tree import model
from momantu_bt.tree.catalogue import CodeText, Queue
from momantu_bt.tree.script_nodes import part
from momantu_bt.tree.types import ValueType, is_union, label, members, origin, parse_type
from momantu_bt.tree.units import UnitError, in_unit, quantity, units_of

__all__ = ["ConversionError", "convert", "natural", "part", "port_of", "render"]

_NUMBER = re.compile(r"[-+]?([0-9]+|[0-9]*\.[0-9]+|[0-9]+\.)([eE][-+]?[0-9]+)?")
_LONGEST_NUMBER = 40
_MISREAD = {"yes": "true", "on": "true", "y": "true", "no": "false", "off": "false", "n": "false"}
_MISREAD |= {"True": "true", "TRUE": "true", "False": "false", "FALSE": "false"}

_BOOLS = {"true": True, "1": True, "false": False, "0": False}
"""What BehaviorTree.CPP takes for a bool within a text."""


class ConversionError(ValueError):
    """A value does not fit a port. The message says what was expected and what would be valid."""


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
            shown = value if isinstance(value, str) else _shown(number)
            unit = f" {port.unit}" if port.unit is not None else ""
            raise ConversionError(f"{shown} is out of range; expected {port.bounds}{unit}")


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
    return "".join(piece if isinstance(piece, str) else _in_words(piece) for piece in parts)


def _in_words(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:g}" if isinstance(value, float) else str(value)


def _convert(value: Any, type_: ValueType, unit: str | None) -> Any:
    if type_ in (object, Any):
        return natural(value)
    if is_union(type_):
        return _to_union(value, type_, unit)
    if origin(type_) is Literal:
        return _to_choice(value, get_args(type_))
    if origin(type_) is Queue:
        return _to_queue(value, get_args(type_)[0])
    if type_ is tuple or origin(type_) is tuple:
        return _to_tuple(value, type_, unit)
    if origin(type_) is np.ndarray:
        return _to_array(value)
    if type_ is bool:
        return _to_bool(value)
    if type_ is int or type_ is float:
        return _to_number(value, type_, unit)
    if isinstance(type_, type) and issubclass(type_, Enum):
        return _to_enum(value, type_)
    if isinstance(type_, type) and issubclass(type_, str):
        return _to_text(value, type_)
    if isinstance(type_, type) and isinstance(value, type_):
        return value
    if dataclasses.is_dataclass(type_) and isinstance(value, Mapping):
        return _to_dataclass(value, type_)
    raise _unfit(value, type_, unit)


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
    raise _unfit(value, type_, unit)


def _to_choice(value: Any, choices: tuple[Any, ...]) -> Any:
    for choice in choices:
        if type(choice) is type(value) and choice == value:
            return choice
    raise ConversionError(f"{_shown(value)} is not one of {_listed(value, choices)}")


def _to_enum(value: Any, type_: type[Enum]) -> Any:
    if isinstance(value, type_):
        return value
    for item in type_:
        if value in (item.value, item.name):
            return item
    raise ConversionError(f"{_shown(value)} is not one of {_listed(value, list(type_))}")


def _listed(value: Any, choices: Sequence[Any]) -> str:
    names = [str(c.value if isinstance(c, Enum) else c) for c in choices]
    near = difflib.get_close_matches(str(value), names, n=1)
    return ", ".join(names) + (f"; did you mean {near[0]}?" if near else "")


def _to_tuple(value: Any, type_: ValueType, unit: str | None) -> Any:
    if not isinstance(value, list | tuple):
        raise ConversionError(f"{_shown(value)} is not a list; expected {label(type_)}: [a, b]")
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
        value = [_in_words(value) if item is str else value]
    found: tuple[Any, ...] = _to_tuple(value, tuple[item, ...], None)  # type: ignore[valid-type]
    return found


def _item(text: str, type_: type) -> Any:
    """One of the values in a text of several, as its type would be written alone."""
    if type_ is str:
        return text
    text = text.strip()
    return _BOOLS.get(text.lower(), text) if type_ is bool else text


def _to_bool(value: Any) -> bool:
    if isinstance(value, bool):
        return value
    if isinstance(value, str) and value in _MISREAD:
        raise ConversionError(f"{value!r} is a text; did you mean {_MISREAD[value]}?")
    raise ConversionError(f"{_shown(value)} is not true or false")


def _to_number(value: Any, type_: type, unit: str | None) -> int | float:
    number = value
    if isinstance(value, str):
        number = _measured(value, type_, unit)
    if isinstance(number, bool) or not isinstance(number, int | float):
        raise _unfit(value, type_, unit)
    if type_ is float:
        return float(number)
    if not math.isfinite(number) or number != int(number):
        raise ConversionError(f"{_shown(value)} is not a whole number")
    return int(number)


def _measured(text: str, type_: type, unit: str | None) -> Any:
    try:
        if unit is not None:
            found = in_unit(text, unit)
            return _plain_number(text) if found is None else found
        plain = quantity(text)
    except UnitError as error:
        raise ConversionError(str(error)) from None
    if plain is None:
        return _plain_number(text)
    if type_ is int:
        raise ConversionError(f"{text!r} has a unit; expected a bare whole number")
    return plain.value


def _plain_number(text: str) -> Any:
    """`010` and `2.50` as numbers: XML has no others; any other text as it is."""
    if not _NUMBER.fullmatch(text) or len(text) > _LONGEST_NUMBER:
        return text
    try:
        return int(text)
    except ValueError:
        number = float(text)
        return number if math.isfinite(number) else text


def _to_text(value: Any, type_: type[str]) -> Any:
    if isinstance(value, str):
        return value
    if type_ is CodeText:
        raise ConversionError(f"{_shown(value)} is not a failure code, such as OBJECT_NOT_FOUND")
    if isinstance(value, bool | int | float):
        shown = _in_words(value)
        raise ConversionError(
            f'{shown} is no text; write "{shown}" in quotes if it is meant as one'
        )
    raise _unfit(value, type_, None)


def _to_array(value: Any) -> Any:
    """A list of numbers, or of such lists, each perhaps with a unit."""
    if isinstance(value, np.ndarray):
        return value
    try:
        array = np.array(natural(value), dtype=np.float64)
    except (TypeError, ValueError):
        array = np.array(math.nan)
    if array.ndim == 0 or not np.isfinite(array).all():
        raise ConversionError(f"{_shown(value)} does not fit; expected a list of numbers")
    array.flags.writeable = False
    return array


def _to_dataclass(value: Mapping[str, Any], type_: Any) -> Any:
    hints = get_type_hints(type_)
    having = {field.name: field for field in dataclasses.fields(type_) if field.init}
    for key in value:
        if key not in having:
            near = difflib.get_close_matches(str(key), having, n=1)
            hint = f", did you mean {near[0]!r}?" if near else "."
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


def _unfit(value: Any, type_: ValueType, unit: str | None) -> ConversionError:
    wanted = label(type_)
    if unit is not None:
        wanted += f" in {unit}, or with one of the units {', '.join(units_of(unit)) or unit}"
    elif dataclasses.is_dataclass(type_):
        wanted += f" {{{', '.join(f.name for f in dataclasses.fields(type_))}}}"
    return ConversionError(f"{_shown(value)} does not fit; expected {wanted}")


def _shown(value: Any) -> str:
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return repr(value)
    if isinstance(value, Mapping):
        return "a mapping"
    if isinstance(value, list | tuple):
        return "a list"
    if isinstance(value, int | float):
        return _in_words(value)
    return f"a {label(type(value))}"

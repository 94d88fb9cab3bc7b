"""Converting single values: choices, booleans, numbers and texts.

All functions raise ConversionError if a value does not fit.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from enum import Enum
from typing import Any

from momantu_bt.failure import CODE
from momantu_bt.formats.names import nearest
from momantu_bt.formats.units import UnitError, in_unit, quantity
from momantu_bt.values.kinds import CodeText
from momantu_bt.values.words import ConversionError, in_words, shown, unfit

_NUMBER = re.compile(r"[-+]?([0-9]+|[0-9]*\.[0-9]+|[0-9]+\.)([eE][-+]?[0-9]+)?")
_LONGEST_NUMBER = 40
_MISREAD = {"yes": "true", "on": "true", "y": "true", "no": "false", "off": "false", "n": "false"}
_MISREAD |= {"True": "true", "TRUE": "true", "False": "false", "FALSE": "false"}


def to_choice(value: Any, choices: tuple[Any, ...]) -> Any:
    """Convert to one of the values of a `Literal`."""
    for choice in choices:
        if type(choice) is type(value) and choice == value:
            return choice
    raise ConversionError(f"{shown(value)} is not one of {_listed(value, choices)}")


def to_enum(value: Any, type_: type[Enum]) -> Any:
    """Convert to a member of an enum, by its value or name."""
    if isinstance(value, type_):
        return value
    for item in type_:
        if value in (item.value, item.name):
            return item
    raise ConversionError(f"{shown(value)} is not one of {_listed(value, list(type_))}")


def _listed(value: Any, choices: Sequence[Any]) -> str:
    names = [str(c.value if isinstance(c, Enum) else c) for c in choices]
    near = nearest(str(value), names)
    return ", ".join(names) + (f"; did you mean {near}?" if near else "")


def to_bool(value: Any) -> bool:
    """Convert to True or False."""
    if isinstance(value, bool):
        return value
    if isinstance(value, str) and value in _MISREAD:
        raise ConversionError(f"{value!r} is a text; did you mean {_MISREAD[value]}?")
    raise ConversionError(f"{shown(value)} is not true or false")


def to_number(value: Any, type_: type, unit: str | None) -> int | float:
    """Convert to a number in SI units. unit: the unit of a number that is given without one."""
    number = value
    if isinstance(value, str):
        number = _measured(value, type_, unit)
    if isinstance(number, bool) or not isinstance(number, int | float):
        raise unfit(value, type_, unit)
    if type_ is float:
        return float(number)
    if not math.isfinite(number) or number != int(number):
        raise ConversionError(f"{shown(value)} is not a whole number")
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
    """Read a text such as `010` or `2.50` as a number, as XML has only texts; else return it."""
    if not _NUMBER.fullmatch(text) or len(text) > _LONGEST_NUMBER:
        return text
    try:
        return int(text)
    except ValueError:
        number = float(text)
        return number if math.isfinite(number) else text


def to_text(value: Any, type_: type[str]) -> Any:
    """Convert to a text."""
    if isinstance(value, str) and (type_ is not CodeText or CODE.fullmatch(value)):
        return value
    if type_ is CodeText:
        raise ConversionError(f"{shown(value)} is not a failure code, such as NOT_FOUND")
    if isinstance(value, bool | int | float):
        said = in_words(value)
        raise ConversionError(f'{said} is not a text; write "{said}" in quotes if you mean a text')
    raise unfit(value, type_, None)

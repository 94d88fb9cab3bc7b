"""Values in messages, and the error of a value that does not fit its port."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

from momantu_bt.formats.units import units_of
from momantu_bt.values.kinds import ValueType
from momantu_bt.values.types import label


class ConversionError(ValueError):
    """A value does not fit a port. The message says what was expected and what would be valid."""


def in_words(value: Any) -> str:
    """A value as it is inserted into a text."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:g}" if isinstance(value, float) else str(value)


def render(parts: Sequence[Any]) -> str:
    """Join the parts of a text; values are inserted as text."""
    return "".join(piece if isinstance(piece, str) else in_words(piece) for piece in parts)


def unfit(value: Any, type_: ValueType, unit: str | None) -> ConversionError:
    """Make the error for a value that does not fit a type. unit: the unit of a number."""
    wanted = label(type_)
    if unit is not None:
        wanted += f" in {unit}, or with one of the units {', '.join(units_of(unit)) or unit}"
    elif dataclasses.is_dataclass(type_):
        wanted += f" {{{', '.join(f.name for f in dataclasses.fields(type_))}}}"
    return ConversionError(f"{shown(value)} does not fit; expected {wanted}")


def shown(value: Any) -> str:
    """A value as a message shows it."""
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
        return in_words(value)
    return f"a {label(type(value))}"

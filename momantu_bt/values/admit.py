"""Checks that a skill's outputs fit their ports' types, and makes them immutable."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType, NoneType
from typing import Any

import numpy as np

from momantu_bt.failure import WRONG_TYPE, Failure
from momantu_bt.skill import Port
from momantu_bt.values import kinds
from momantu_bt.values.contents import freeze, nan_in, retuple
from momantu_bt.values.kinds import ValueKind, ValueType, kind_of


def admit(value: Any, port: Port) -> Any:
    """Check that a value fits the port, and make it immutable; an int becomes a float if needed.

    Raises:
        Failure: WRONG_TYPE, the value does not fit; the message says what was expected.
    """
    if type(value) is port.type and port.type in _PLAIN:
        return value
    try:
        return _admitted(value, kind_of(port.type))
    except _MisfitError:
        raise Failure(
            WRONG_TYPE,
            f"port {port.name} got {_shown(value)} of type {type(value).__name__}, "
            f"expected {type_text(port.type)}",
            port=port.name,
            got=type(value).__name__,
            expected=type_text(port.type),
        ) from None


def admit_output(value: Any, port: Port) -> Any:
    """As `admit`, but NaN is not allowed either.

    Raises:
        Failure: WRONG_TYPE, the value does not fit or holds a NaN. A robot must never get one.
    """
    admitted = admit(value, port)
    if admitted == admitted if type(admitted) is float else type(admitted) in _WITHOUT_NAN:
        return admitted
    where = nan_in(admitted)
    if where is None:
        return admitted
    raise Failure(
        WRONG_TYPE,
        f"port {port.name} got a value whose {'.'.join((port.name, *where))} is NaN, "
        "expected numbers",
        port=port.name,
        got="NaN",
        expected=type_text(port.type),
    )


def type_text(annotation: ValueType) -> str:
    """A type as Python code."""
    return annotation.__name__ if isinstance(annotation, type) else str(annotation)


_PLAIN = frozenset((bool, int, float, str))
"""Types whose values fit a port of the same type as they are."""

_WITHOUT_NAN = frozenset((bool, int, str, NoneType))
"""Types whose values cannot hold a NaN."""


class _MisfitError(Exception):
    """The value does not fit the kind."""


def _admitted(value: Any, kind: ValueKind) -> Any:
    """The value converted to a kind; raises _MisfitError if it does not fit."""
    match kind:
        case kinds.Number():
            return _number(value, kind)
        case kinds.Anything() | kinds.Unknown():
            return freeze(value)
        case kinds.Text():
            return _instance(value, str)
        case (
            kinds.Truth()
            | kinds.Enumeration()
            | kinds.Record()
            | kinds.Instance()
            | kinds.Nothing()
        ):
            return _instance(value, kind.type)
        case kinds.Choice():
            return _choice(value, kind)
        case kinds.Array():
            return freeze(_instance(value, np.ndarray))
        case kinds.Either():
            return _option(value, kind)
        case kinds.Items() | kinds.QueueOf():
            return _items(value, kind)
        case kinds.Fixed():
            return _fixed(value, kind)
        case kinds.Table():
            return _table(value, kind)


def _instance(value: Any, type_: ValueType) -> Any:
    if isinstance(value, type_):
        return value
    raise _MisfitError


def _number(value: Any, kind: kinds.Number) -> Any:
    if type(value) is int and kind.type is float:
        return float(value)
    if isinstance(value, bool):
        raise _MisfitError
    return _instance(value, kind.type)


def _choice(value: Any, kind: kinds.Choice) -> Any:
    if any(type(value) is type(choice) and value == choice for choice in kind.values):
        return value
    raise _MisfitError


def _option(value: Any, kind: kinds.Either) -> Any:
    """Convert to the first option that keeps the value unchanged, or else that accepts it."""
    found = []
    for option in kind.options:
        try:
            found.append(_admitted(value, option))
        except _MisfitError:
            continue
        if found[-1] is value:
            return value
    if not found:
        raise _MisfitError
    return found[0]


def _items(value: Any, kind: kinds.Items | kinds.QueueOf) -> tuple[Any, ...]:
    found = _instance(value, (list, tuple))
    return retuple(found, [_admitted(item, kind.item) for item in found])


def _fixed(value: Any, kind: kinds.Fixed) -> tuple[Any, ...]:
    found = _instance(value, (list, tuple))
    if len(found) != len(kind.items):
        raise _MisfitError
    return retuple(found, list(map(_admitted, found, kind.items)))


def _table(value: Any, kind: kinds.Table) -> Mapping[Any, Any]:
    found = _instance(value, Mapping)
    return MappingProxyType(
        {_admitted(key, kind.key): _admitted(item, kind.item) for key, item in found.items()}
    )


def _shown(value: Any, limit: int = 60) -> str:
    text = repr(value)
    return text if len(text) <= limit else text[: limit - 1] + "…"

"""Values at ports: whether they fit the port's type, and how they become immutable."""

from __future__ import annotations

import types
from collections.abc import Mapping
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import numpy as np

from momantu_bt.engine.nan import nan_in
from momantu_bt.failure import WRONG_TYPE, Failure
from momantu_bt.skill import Port


def admit(value: Any, port: Port) -> Any:
    """The value as the port takes it: an int becomes a float where a float is asked.

    Raises:
        Failure: WRONG_TYPE, with what came and what was expected.
    """
    if type(value) is port.type or fits(value, port.type):
        return value
    if type(value) is int and fits(float(value), port.type):
        return float(value)
    raise Failure(
        WRONG_TYPE,
        f"port {port.name} got {_shown(value)} of type {type(value).__name__}, "
        f"expected {type_text(port.type)}",
        port=port.name,
        got=type(value).__name__,
        expected=type_text(port.type),
    )


def admit_output(value: Any, port: Port) -> Any:
    """What a skill gives, made immutable, and with a number wherever there should be one.

    Raises:
        Failure: WRONG_TYPE, also for a NaN: nobody may move by one.
    """
    admitted = admit(freeze(value), port)
    where = None if type(admitted) in _WITHOUT_NAN else nan_in(admitted)
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


def fits(value: Any, annotation: Any) -> bool:
    """Whether a value is of an annotated type; protocols and type variables accept anything."""
    if annotation is Any or annotation is object:
        return True
    if annotation is None:
        return value is None
    origin = get_origin(annotation)
    if origin is None:
        return _is_instance(value, annotation)
    arguments = get_args(annotation)
    if origin is Annotated:
        return fits(value, arguments[0])
    if origin is Union or origin is types.UnionType:
        return any(fits(value, option) for option in arguments)
    if origin is Literal:
        return any(type(value) is type(option) and value == option for option in arguments)
    if origin is tuple:
        return isinstance(value, tuple) and _tuple_fits(value, arguments)
    if origin is list:
        return isinstance(value, list | tuple) and all(fits(v, arguments[0]) for v in value)
    return _is_instance(value, origin)


_WITHOUT_NAN = frozenset((bool, int, str, type(None)))
"""Types of values that hold no NaN."""

_IMMUTABLE: Mapping[Any, Any] = types.MappingProxyType({list: tuple | list, dict: Mapping})
"""What a frozen value of a kind is."""


def _is_instance(value: Any, kind: Any) -> bool:
    if isinstance(value, bool):
        return kind is bool
    kind = _IMMUTABLE.get(kind, kind)
    try:
        return isinstance(value, kind)
    except TypeError:
        return True


def _tuple_fits(value: tuple[Any, ...], arguments: tuple[Any, ...]) -> bool:
    if len(arguments) == 2 and arguments[1] is Ellipsis:
        return all(fits(item, arguments[0]) for item in value)
    return len(value) == len(arguments) and all(map(fits, value, arguments))


def type_text(annotation: Any) -> str:
    """A type as a person writes it."""
    if isinstance(annotation, type) and get_origin(annotation) is None:
        return annotation.__name__
    return str(annotation).replace("typing.", "")


def _shown(value: Any, limit: int = 60) -> str:
    text = repr(value)
    return text if len(text) <= limit else text[: limit - 1] + "…"


_PLAIN = frozenset((bool, int, float, str, type(None)))
"""Types of values that are immutable as they are."""


def freeze(value: Any) -> Any:
    """The same value made immutable: lists become tuples, arrays read-only, mappings proxies."""
    if type(value) in _PLAIN:
        return value
    if isinstance(value, list | tuple) and type(value) in (list, tuple):
        return tuple(freeze(item) for item in value)
    if isinstance(value, np.ndarray):
        if value.flags.writeable:
            value = value.copy()
            value.setflags(write=False)
        return value
    if isinstance(value, dict):
        return types.MappingProxyType({key: freeze(item) for key, item in value.items()})
    return value

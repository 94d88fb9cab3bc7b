"""Functions that go through all parts of a value: to make it immutable, or to find a NaN."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from types import MappingProxyType, NoneType
from typing import Any

import numpy as np

_PLAIN = frozenset((bool, int, float, str, NoneType))
"""Types whose values are always immutable."""


def freeze(value: Any) -> Any:
    """Make a value immutable: lists become tuples, arrays read-only, mappings read-only proxies."""
    if type(value) in _PLAIN:
        return value
    if type(value) in (list, tuple):
        return tuple(freeze(item) for item in value)
    if isinstance(value, np.ndarray):
        if value.flags.writeable:
            value = value.copy()
            value.setflags(write=False)
        return value
    if isinstance(value, dict):
        return MappingProxyType({key: freeze(item) for key, item in value.items()})
    return value


def retuple(value: list[Any] | tuple[Any, ...], items: list[Any]) -> tuple[Any, ...]:
    """The items as a tuple; the value itself if it is already a tuple of these objects."""
    if isinstance(value, tuple) and all(a is b for a, b in zip(items, value, strict=True)):
        return value
    return tuple(items)


def nan_in(value: Any) -> tuple[str, ...] | None:
    """Find a NaN in a value: its path of field names, keys and indices, or None.

    Searches lists, mappings, arrays and dataclasses.
    """
    stack: list[tuple[tuple[str, ...], Any]] = [((), value)]
    seen: set[int] = set()
    while stack:
        way, part = stack.pop()
        if isinstance(part, float | np.floating):
            if part != part:
                return way
        elif isinstance(part, np.ndarray):
            if part.dtype.kind in "fc" and bool(np.isnan(part).any()):
                return way
        elif not isinstance(part, str | int) and id(part) not in seen:
            seen.add(id(part))
            inside = [((*way, name), item) for name, item in _parts(part)]
            stack.extend(reversed(inside))
    return None


def _parts(value: Any) -> Iterable[tuple[str, Any]]:
    if isinstance(value, Mapping):
        return ((str(key), item) for key, item in value.items())
    if isinstance(value, list | tuple):
        return ((str(index), item) for index, item in enumerate(value))
    if is_dataclass(value) and not isinstance(value, type):
        return ((f.name, getattr(value, f.name)) for f in fields(value))
    return ()

"""Encodes values as bytes; equal values give the same bytes in every process."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache
from types import NoneType
from typing import Any, TypeAlias

import numpy as np

from momantu_bt.failure import FailureValue
from momantu_bt.messages import ENCODED_IF_SET
from momantu_bt.skill import MISSING

_FLOAT = struct.Struct("<d").pack
_PLACE, _TRACEBACK = "place", "traceback"
"""Parts of a failure that depend on where files are; they are left out."""

_Writer: TypeAlias = Callable[[Any, list[bytes]], None]


def encode(value: Any) -> bytes:
    """Canonical bytes of a value: all bits of each float, mappings sorted by key.

    For a value of an unknown kind, only the name of its type is encoded.
    """
    if type(value) is float:
        return b"f" + _FLOAT(value)
    parts: list[bytes] = []
    _writer(type(value))(value, parts)
    return b"".join(parts)


def _find_writer(kind: Any) -> _Writer:
    for base, write in _WRITERS:
        if issubclass(kind, base):
            return write
    return _dataclass(kind) if is_dataclass(kind) else _unknown


_writer: Callable[[Any], _Writer] = cache(_find_writer)
"""The writer for values of a type, cached."""


def _float(value: float, out: list[bytes]) -> None:
    out.append(b"f" + _FLOAT(value))


def _by_name(value: Any, out: list[bytes]) -> None:
    out.append(f"{type(value).__name__}:{value!r};".encode())


def _text(value: str, out: list[bytes]) -> None:
    text = value.encode("utf-8", "surrogatepass")
    out.append(b"s%d:" % len(text) + text)


def _array(value: np.ndarray[Any, Any], out: list[bytes]) -> None:
    if value.dtype.hasobject:
        held = value.tolist()
        _writer(type(held))(held, out)
    else:
        out.append(f"a{value.dtype.str}{value.shape}".encode() + value.tobytes())


def _scalar(value: np.generic, out: list[bytes]) -> None:
    held = value.item()
    _writer(type(held))(held, out)


def _mapping(value: Mapping[Any, Any], out: list[bytes]) -> None:
    out.append(b"m%d:" % len(value))
    for key in sorted(value, key=str):
        if key != _TRACEBACK:
            _text(str(key), out)
            item = value[key]
            _writer(type(item))(item, out)


def _list(value: list[Any] | tuple[Any, ...], out: list[bytes]) -> None:
    out.append(b"l%d:" % len(value))
    for item in value:
        _writer(type(item))(item, out)


def _failure(value: FailureValue, out: list[bytes]) -> None:
    names = (field.name for field in fields(value))
    _mapping({name: getattr(value, name) for name in names if name != _PLACE}, out)


def _dataclass(kind: Any) -> _Writer:
    name, names = kind.__qualname__.encode(), [field.name for field in fields(kind)]
    unset = {
        f.name: f.default for f in fields(kind) if ENCODED_IF_SET.items() <= f.metadata.items()
    }

    def write(value: Any, out: list[bytes]) -> None:
        out.append(name)
        for each in names:
            item = getattr(value, each)
            if each not in unset or item != unset[each]:
                _writer(type(item))(item, out)

    return write


def _unknown(value: Any, out: list[bytes]) -> None:
    out.append(f"?{type(value).__qualname__};".encode())


_WRITERS: tuple[tuple[Any, _Writer], ...] = (
    (float, _float),
    (NoneType | type(MISSING) | bool | int | Enum, _by_name),
    (str, _text),
    (np.ndarray, _array),
    (np.generic, _scalar),
    (Mapping, _mapping),
    (list | tuple, _list),
    (FailureValue, _failure),
)
"""The writer for each type; the first that fits is used. Other types are dataclasses or unknown."""

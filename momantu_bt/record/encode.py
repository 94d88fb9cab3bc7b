"""Values as bytes, the same bytes for the same value in every process."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

import numpy as np

from momantu_bt.failure import FailureValue
from momantu_bt.skill import MISSING

_FLOAT = struct.Struct("<d").pack
_PLACE, _TRACEBACK = "place", "traceback"
"""Parts of a failure that depend on where the files lie; neither enters."""


def encode(value: Any) -> bytes:
    """Canonical bytes: every float to its last bit, mappings in the order of their keys.

    A value of an unknown kind counts by its type alone.
    """
    if type(value) is float:
        return b"f" + _FLOAT(value)
    parts: list[bytes] = []
    _encode(value, parts)
    return b"".join(parts)


def _encode(value: Any, out: list[bytes]) -> None:
    if isinstance(value, float):
        out.append(b"f" + _FLOAT(value))
    elif value is None or value is MISSING or isinstance(value, bool | int | Enum):
        out.append(f"{type(value).__name__}:{value!r};".encode())
    elif isinstance(value, str):
        text = value.encode("utf-8", "surrogatepass")
        out.append(b"s%d:" % len(text) + text)
    elif isinstance(value, np.ndarray) and value.dtype.hasobject:
        _encode(value.tolist(), out)
    elif isinstance(value, np.ndarray):
        out.append(f"a{value.dtype.str}{value.shape}".encode() + value.tobytes())
    elif isinstance(value, np.generic):
        _encode(value.item(), out)
    elif isinstance(value, Mapping):
        _encode_mapping(value, out)
    elif isinstance(value, list | tuple):
        out.append(b"l%d:" % len(value))
        for item in value:
            _encode(item, out)
    elif isinstance(value, FailureValue):
        named = {f.name: getattr(value, f.name) for f in fields(value)}
        _encode_mapping({k: v for k, v in named.items() if k != _PLACE}, out)
    elif is_dataclass(value):
        out.append(type(value).__qualname__.encode())
        for field in fields(value):
            _encode(getattr(value, field.name), out)
    else:
        out.append(f"?{type(value).__qualname__};".encode())


def _encode_mapping(value: Mapping[Any, Any], out: list[bytes]) -> None:
    out.append(b"m%d:" % len(value))
    for key in sorted(value, key=str):
        if key != _TRACEBACK:
            _encode(str(key), out)
            _encode(value[key], out)

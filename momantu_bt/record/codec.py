"""Values as JSON and back, without loss.

None, booleans, numbers and texts stay as they are. The two containers of the board become their
JSON counterparts: a tuple an array, a read-only mapping with text keys an object. Everything else
becomes an object with keys that begin with `$`, for example a dataclass:
`{"$type": "momantu_bt.geometry:Pose2D", "x": 1.0, …}`.
"""

from __future__ import annotations

import base64
import json
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from functools import cache
from pathlib import Path, PurePath
from types import MappingProxyType
from typing import Any

import numpy as np

from momantu_bt.record.codec_types import find_type, type_name
from momantu_bt.skill import MISSING

MAX_DEPTH = 60
"""Deepest nesting of values; `to_json` writes a deeper value as text."""
FEW = 16
"""Arrays with at most this many elements are written as readable numbers, longer ones in base64."""
_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")

dumps: Callable[[Any], str] = json.JSONEncoder(separators=(",", ":"), allow_nan=False).encode
"""JSON data as text, in ASCII and without spaces."""


@dataclass(frozen=True, slots=True)
class Opaque:
    """A placeholder for a value that JSON cannot hold, or whose type is not installed."""

    type: str
    text: str


class CodecError(ValueError):
    """The JSON data was not made by `to_json`."""


def to_json(value: Any) -> Any:
    """JSON data for any value; a value that cannot be encoded is written like an `Opaque`."""
    return _to_json(value, MAX_DEPTH)


def to_text(value: Any) -> str:
    """`dumps(to_json(value))`, quicker for a dataclass that holds nothing but finite floats."""
    kind: Any = type(value)
    if is_dataclass(type(value)):
        head, names = _flat(kind)
        numbers = [getattr(value, name) for name in names]
        if all(type(number) is float and math.isfinite(number) for number in numbers):
            pairs = [f',"{name}":{number!r}' for name, number in zip(names, numbers, strict=True)]
            return f"{head}{''.join(pairs)}}}"
    return dumps(to_json(value))


@cache
def _flat(kind: Any) -> tuple[str, tuple[str, ...]]:
    head = f'{{"$type":{dumps(type_name(kind))}'
    return head, tuple(field.name for field in fields(kind))


def from_json(data: Any) -> Any:
    """The value that `to_json` was given.

    Raises:
        CodecError: the data was not made by `to_json`.
    """
    try:
        return _from_json(data, 3 * MAX_DEPTH)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise CodecError(f"{_short(data)} is not a value of a record: {error}") from None


def _to_json(value: Any, depth: int) -> Any:
    kind: Any = type(value)
    if kind is float:
        return value if math.isfinite(value) else {"$float": repr(value)}
    if value is None or kind is str or kind is bool or kind is int:
        return value
    if depth == 0:
        return _opaque(value)
    if kind is tuple:
        return [_to_json(item, depth - 1) for item in value]
    if kind is MappingProxyType:
        return _mapping(value, depth)
    return _writer(kind)(value, depth)


@cache
def _writer(kind: type[Any]) -> Callable[[Any, int], dict[str, Any]]:
    """The writer for values of a type, cached."""
    for test, write in _WRITERS:
        if issubclass(kind, test):
            return write
    return _dataclass(kind) if is_dataclass(kind) else _opaque


def _mapping(value: Mapping[Any, Any], depth: int) -> dict[str, Any]:
    if all(type(key) is str and not key.startswith("$") for key in value):
        return {key: _to_json(item, depth - 1) for key, item in value.items()}
    pairs = [[_to_json(k, depth - 1), _to_json(v, depth - 1)] for k, v in value.items()]
    return {"$mapping": pairs}


def _array(value: np.ndarray[Any, Any], depth: int) -> dict[str, Any]:
    if value.dtype.hasobject or value.dtype.kind not in "biuf":
        return _opaque(value)
    short = value.size <= FEW and bool(np.isfinite(value).all())
    held = value.ravel()
    data = held.tolist() if short else base64.b64encode(held.tobytes()).decode("ascii")
    return {"$array": value.dtype.str, "shape": list(value.shape), "data": data}


def _dataclass(kind: Any) -> Callable[[Any, int], dict[str, Any]]:
    name, names = type_name(kind), [field.name for field in fields(kind)]

    def write(value: Any, depth: int) -> dict[str, Any]:
        made: dict[str, Any] = {"$type": name}
        for each in names:
            made[each] = _to_json(getattr(value, each), depth - 1)
        return made

    return write


def _tuple(value: tuple[Any, ...], depth: int) -> dict[str, Any]:
    return {"$tuple": type_name(type(value)), "items": [_to_json(v, depth - 1) for v in value]}


def _set(value: set[Any] | frozenset[Any], depth: int) -> dict[str, Any]:
    """Items sorted by their text, as the order of a set differs between processes."""
    tag = "$set" if isinstance(value, set) else "$frozenset"
    return {tag: sorted((_to_json(item, depth - 1) for item in value), key=dumps)}


def _scalar(value: np.generic, depth: int) -> dict[str, Any]:
    return {"$scalar": _array(np.asarray(value), depth)}


def _opaque(value: Any, depth: int = 0) -> dict[str, Any]:
    if isinstance(value, Opaque):
        return {"$opaque": value.type, "text": value.text}
    try:
        text = repr(value)
    except Exception as error:
        text = f"its repr raises {type(error).__name__}"
    return {"$opaque": type_name(type(value)), "text": _ADDRESS.sub("", text)[:2000]}


def _enum(value: Enum, depth: int) -> dict[str, Any]:
    return {"$enum": type_name(type(value)), "name": value.name}


_WRITERS: tuple[tuple[Any, Callable[[Any, int], dict[str, Any]]], ...] = (
    (Opaque, _opaque),
    (type(MISSING), lambda value, depth: {"$missing": True}),
    (Enum, _enum),
    (np.ndarray, _array),
    (np.generic, _scalar),
    (dict, lambda value, depth: {"$dict": _mapping(value, depth)}),
    (Mapping, _mapping),
    (list, lambda value, depth: {"$list": [_to_json(item, depth - 1) for item in value]}),
    (tuple, _tuple),
    (set | frozenset, _set),
    (bytes, lambda value, depth: {"$bytes": base64.b64encode(value).decode("ascii")}),
    (PurePath, lambda value, depth: {"$path": str(value)}),
)
"""The writer for each type; the first that fits is used. Types that JSON has never get here."""


def _from_json(data: Any, depth: int) -> Any:
    if depth == 0:
        raise CodecError("it is nested too deep")
    if isinstance(data, list):
        return tuple(_from_json(item, depth - 1) for item in data)
    if not isinstance(data, dict):
        return data
    tag = next(iter(data), "")
    if not tag.startswith("$"):
        return MappingProxyType({key: _from_json(item, depth - 1) for key, item in data.items()})
    if tag not in _READERS:
        raise CodecError(f"nothing is called {tag}; there are: {', '.join(_READERS)}")
    return _READERS[tag](data, lambda item: _from_json(item, depth - 1))


def _read_array(data: Any, inner: Callable[[Any], Any]) -> np.ndarray[Any, Any]:
    kind = np.dtype(data["$array"])
    if kind.kind not in "biuf":
        raise CodecError(f"an array of {data['$array']} holds no numbers")
    held = data["data"]
    if isinstance(held, str):
        array = np.frombuffer(base64.b64decode(held, validate=True), dtype=kind)
    else:
        array = np.array(held, dtype=kind)
    array = array.reshape([int(n) for n in data["shape"]])
    array.setflags(write=False)
    return array


def _read_dataclass(data: Any, inner: Callable[[Any], Any]) -> Any:
    """Set the fields without `__init__`, which may change them (it normalizes a quaternion)."""
    kind = find_type(data["$type"])
    named = {key: item for key, item in data.items() if key != "$type"}
    if kind is None or not is_dataclass(kind) or {f.name for f in fields(kind)} != set(named):
        return Opaque(data["$type"], dumps(named))
    made = object.__new__(kind)
    for name, item in named.items():
        object.__setattr__(made, name, inner(item))
    return made


def _read_enum(data: Any, inner: Callable[[Any], Any]) -> Any:
    kind = find_type(data["$enum"])
    if kind is None or not issubclass(kind, Enum) or data["name"] not in kind.__members__:
        return Opaque(data["$enum"], str(data["name"]))
    return kind[data["name"]]


def _read_tuple(data: Any, inner: Callable[[Any], Any]) -> Any:
    kind = find_type(data["$tuple"])
    if kind is None or not issubclass(kind, tuple):
        return Opaque(data["$tuple"], dumps(data["items"]))
    return tuple.__new__(kind, inner(data["items"]))


def _read_mapping(data: Any, inner: Callable[[Any], Any]) -> Any:
    return MappingProxyType({inner(key): inner(item) for key, item in data["$mapping"]})


_READERS: Mapping[str, Callable[[Any, Callable[[Any], Any]], Any]] = {
    "$type": _read_dataclass,
    "$array": _read_array,
    "$enum": _read_enum,
    "$tuple": _read_tuple,
    "$mapping": _read_mapping,
    "$float": lambda data, inner: float(data["$float"]),
    "$scalar": lambda data, inner: inner(data["$scalar"])[()],
    "$dict": lambda data, inner: dict(inner(data["$dict"])),
    "$list": lambda data, inner: list(inner(data["$list"])),
    "$set": lambda data, inner: set(inner(data["$set"])),
    "$frozenset": lambda data, inner: frozenset(inner(data["$frozenset"])),
    "$bytes": lambda data, inner: base64.b64decode(data["$bytes"], validate=True),
    "$path": lambda data, inner: Path(data["$path"]),
    "$missing": lambda data, inner: MISSING,
    "$opaque": lambda data, inner: Opaque(data["$opaque"], data["text"]),
}


def _short(data: Any, limit: int = 80) -> str:
    text = repr(data)
    return text if len(text) <= limit else text[: limit - 1] + "…"

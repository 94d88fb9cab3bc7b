"""Finding a NaN in a value, however deep it is."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np


def nan_in(value: Any) -> tuple[str, ...] | None:
    """The way to a NaN in a value, by names of fields, keys and places in lists; None: it has none.

    Looks into lists, mappings, arrays and dataclasses.
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

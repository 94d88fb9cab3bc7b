"""Replacing all numbers in a value with NaN."""

from __future__ import annotations

import math
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np

from momantu_bt.geometry import Transform


def without_numbers(value: Any) -> Any:
    """The same value, each float in it NaN; whole numbers have no NaN and stay.

    A transform keeps its turn: one of no length is refused where it is made.
    """
    if isinstance(value, float):
        return math.nan
    if isinstance(value, Transform):
        return Transform((math.nan,) * 3, value.quaternion)
    if isinstance(value, np.ndarray) and value.dtype.kind == "f":
        return np.full_like(value, math.nan)
    if type(value) in (list, tuple):
        return type(value)(without_numbers(item) for item in value)
    if is_dataclass(value) and not isinstance(value, type):
        parts = {f.name: without_numbers(getattr(value, f.name)) for f in fields(value) if f.init}
        return replace(value, **parts)
    return value

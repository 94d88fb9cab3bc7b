"""Columns of numbers and tables of texts: a record's data as compact JSON."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from momantu_bt.failure import FailureValue
from momantu_bt.record.codec import Opaque
from momantu_bt.skill import MISSING

WIDEST = 300
"""Most characters of a value; longer values are cut."""
_FEW = 16
"""Most elements of an array that are written out."""
_CLEARED = "(no value)"


class Texts:
    """Texts, each stored once, by number."""

    def __init__(self, *texts: str) -> None:
        self.texts: list[str] = list(texts)
        self._numbers = {text: number for number, text in enumerate(texts)}

    def number(self, text: str) -> int:
        """The number of a text."""
        found = self._numbers.setdefault(text, len(self.texts))
        if found == len(self.texts):
            self.texts.append(text)
        return found


def value_text(value: Any) -> str:
    """A value in one line, numbers to 4 digits: `{frame: odom, position: [1.2, 0.31, 0.74]}`."""
    words = _words(value)
    return words if len(words) <= WIDEST else words[: WIDEST - 1] + "…"


def _words(value: Any) -> str:
    """Values of a record, nested at most as deeply as its codec allows."""
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, bool):
        return {None: "nothing", True: "true", False: "false"}[value]
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, Opaque):
        return value.text
    if isinstance(value, FailureValue):
        return str(value)
    if isinstance(value, np.ndarray):
        if value.size > _FEW:
            return f"array of {' x '.join(map(str, value.shape))}"
        value = value.tolist()
    if is_dataclass(value):
        value = {field.name: getattr(value, field.name) for field in fields(value)}
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key}: {_words(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_words, value)) + "]"
    return _CLEARED if value is MISSING else str(value)

"""Plain scalars by YAML 1.2's core schema."""

from __future__ import annotations

import math
import re
from typing import Any

_NULL = re.compile(r"|~|null|Null|NULL")
_INT = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_LARGEST_NUMBER = 40
"""Most digits of a number; longer ones stay texts, as no port takes them."""


def resolve(text: str) -> Any:
    """The value of a plain scalar by YAML 1.2's core schema, but .inf and .nan stay texts."""
    if _NULL.fullmatch(text):
        return None
    if text in ("true", "false"):
        return text == "true"
    if len(text) > _LARGEST_NUMBER:
        return text
    if _INT.fullmatch(text):
        return int(text, 0) if text[:2] in ("0x", "0o") else int(text)
    if not _FLOAT.fullmatch(text):
        return text
    number = float(text)
    return number if math.isfinite(number) else text

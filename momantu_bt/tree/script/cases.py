"""When a value matches a case of a switch."""

from __future__ import annotations

from enum import Enum
from typing import Any

from momantu_bt.tree.script.nodes import EPSILON, number_in


def is_case(value: Any, case: Any) -> bool:
    """Whether a value matches a case: they are equal, or equal as texts or as numbers.

    A text such as "3" counts as a number, `true` does not. Numbers are equal within `EPSILON`.
    """
    value, case = (_bare(value), _bare(case))
    if type(value) is type(case) and value == case:
        return True
    left, right = _number(value), _number(case)
    return left is not None and right is not None and abs(left - right) <= EPSILON


def _bare(value: Any) -> Any:
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, bool):
        return "true" if value else "false"
    return value


def _number(value: Any) -> float | None:
    if isinstance(value, str):
        return None if value in ("true", "false") else number_in(value)
    return float(value) if isinstance(value, int | float) else None

"""Pydantic's errors in plain words: what is expected and what is written."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, TypeAlias

from momantu_bt.formats.names import nearest

_LONGEST = 60
"""Characters of a value that a message repeats."""
_Say: TypeAlias = Callable[[dict[str, Any]], str]


def said(finding: dict[str, Any], keys: Sequence[str]) -> str:
    """The problem of a value. keys: the valid ones, if a mapping is expected."""
    say = _WORDS.get(finding["type"])
    if say is not None:
        return say(finding)
    if finding["type"] in ("model_type", "model_attributes_type", "dict_type"):
        named = f" with the keys {', '.join(keys)}" if keys else " of names to what they mean"
        return f"expected a mapping{named}; found {_found(finding)}"
    message = str(finding["msg"]).removeprefix("Value error, ")
    return message.replace("Input should be", "expected to be", 1)


def _found(finding: dict[str, Any]) -> str:
    text = repr(finding["input"])
    if finding["input"] is None:
        return "nothing"
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"


def _wanted(what: str) -> _Say:
    return lambda finding: f"expected {what}; found {_found(finding)}"


def _count(finding: dict[str, Any]) -> str:
    told = finding["ctx"]
    bound, limit = ("at least", "min_length") if "min_length" in told else ("at most", "max_length")
    number, actual = told[limit], told["actual_length"]
    if str(told.get("field_type", "")) == "String":
        return f"expected {bound} {number} characters"
    return f"expected {bound} {number} value{'s' * (number != 1)}, found {actual}"


def _choice(finding: dict[str, Any]) -> str:
    possible = re.findall(r"'([^']*)'", str(finding["ctx"]["expected"]))
    near = nearest(str(finding["input"]), possible)
    hint = f"did you mean {near!r}? Possible" if near else "possible"
    listed = ", ".join(map(repr, possible)) or finding["ctx"]["expected"]
    return f"{_found(finding)} is not possible here; {hint}: {listed}"


_NAME = "a name: lower-case letters, digits and _, beginning with a letter"
_WORDS: Mapping[str, _Say] = MappingProxyType(
    {
        "tuple_type": _wanted("a list"),
        "list_type": _wanted("a list"),
        "string_type": _wanted("a text"),
        "bool_type": _wanted("true or false"),
        "bool_parsing": _wanted("true or false"),
        "int_type": _wanted("a whole number"),
        "int_parsing": _wanted("a whole number"),
        "int_from_float": _wanted("a whole number"),
        "float_type": _wanted("a number"),
        "float_parsing": _wanted("a number"),
        "finite_number": _wanted("a number that is not infinite"),
        "string_pattern_mismatch": _wanted(_NAME),
        "too_short": _count,
        "too_long": _count,
        "string_too_short": lambda finding: f"expected a text; found {_found(finding)}",
        "string_too_long": lambda f: f"expected at most {f['ctx']['max_length']} characters",
        "literal_error": _choice,
        "enum": _choice,
    }
)

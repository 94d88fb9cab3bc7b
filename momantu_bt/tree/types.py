"""Port types by the names that trees use, and which value may flow into which port."""

from __future__ import annotations

import types
from enum import Enum
from typing import Any, Literal, TypeAlias, Union, get_args
from typing import get_origin as _get_origin

from momantu_bt.messages import VALUE_TYPES
from momantu_bt.tree.catalogue import Queue

ValueType: TypeAlias = Any
"""A Python type as ports declare it: a class, `X | None`, `tuple[X, ...]`, `Literal[...]`."""

_LIST_OF = "list of "


def origin(type_: ValueType) -> Any:
    """`Literal`, `tuple`, `Union` … of a type with parameters; None of a plain class."""
    return _get_origin(type_)


def parse_type(text: str) -> ValueType:
    """`text`, `pose2d`, `list of number` as a Python type.

    Raises:
        KeyError: no type has this name; the argument is the unknown part.
    """
    text = text.strip()
    depth = 0
    while text.startswith(_LIST_OF):
        text, depth = text[len(_LIST_OF) :].strip(), depth + 1
    if text not in VALUE_TYPES:
        raise KeyError(text)
    found: ValueType = VALUE_TYPES[text]
    for _ in range(depth):
        found = tuple[found, ...]
    return found


def label(type_: ValueType) -> str:
    """A type in the words of tree files: "list of pose", "text or pose2d", "'a' or 'b'"."""
    if type_ in (object, Any):
        return "any"
    if origin(type_) is Literal:
        return " or ".join(repr(value) for value in get_args(type_))
    if is_union(type_):
        return " or ".join(label(m) for m in members(type_) if m is not type(None))
    if origin(type_) is Queue:
        return f"list of {label(get_args(type_)[0])}"
    if origin(type_) is tuple:
        return _tuple_label(get_args(type_))
    for name, known in VALUE_TYPES.items():
        if known is type_:
            return name
    if isinstance(type_, type) and issubclass(type_, Enum):
        return " or ".join(repr(item.value) for item in type_)
    if isinstance(type_, type) and issubclass(type_, str):
        return "text"
    return str(getattr(type_, "__name__", type_))


def _tuple_label(items: tuple[Any, ...]) -> str:
    if len(items) == 2 and items[1] is Ellipsis:
        return f"list of {label(items[0])}"
    if items and all(item == items[0] for item in items):
        return f"list of {len(items)} {label(items[0])}"
    return f"list of ({', '.join(label(item) for item in items)})"


def is_union(type_: ValueType) -> bool:
    """Whether it is `A | B` or `Optional[A]`."""
    return origin(type_) in (Union, types.UnionType)


def members(type_: ValueType) -> tuple[ValueType, ...]:
    """The alternatives of a union, or the type alone."""
    return get_args(type_) if is_union(type_) else (type_,)


def without_none(type_: ValueType) -> tuple[ValueType, ...]:
    """The alternatives except None."""
    return tuple(m for m in members(type_) if m is not type(None))


def assignable(source: ValueType, target: ValueType) -> bool:
    """Whether a value of type `source` can be right for a port of type `target`.

    Errs on the side of yes where only the value can tell: `any`, unions, choices of texts.
    """
    if source == target or source in (object, Any) or target in (object, Any):
        return True
    if is_union(source):
        return any(assignable(member, target) for member in members(source))
    if is_union(target):
        return any(assignable(source, member) for member in members(target))
    if origin(target) is Queue:
        item = get_args(target)[0]
        listed: ValueType = tuple[item, ...]  # type: ignore[valid-type]
        return source is str or assignable(source, listed) or assignable(source, item)
    if origin(source) is Literal:
        return any(assignable(type(value), target) for value in get_args(source))
    if origin(target) is Literal:
        return any(source is type(value) for value in get_args(target))
    if origin(target) is tuple or origin(source) is tuple:
        return _tuples(source, target)
    if target is float:
        return source in (int, float)
    if target is int:
        return source is int
    if isinstance(target, type) and issubclass(target, str | Enum):
        return isinstance(source, type) and issubclass(source, str)
    return isinstance(source, type) and isinstance(target, type) and issubclass(source, target)


def _tuples(source: ValueType, target: ValueType) -> bool:
    if source is tuple or target is tuple:
        return (origin(source) or source) is (origin(target) or target)
    if origin(source) is not tuple or origin(target) is not tuple:
        return False
    left, right = get_args(source), get_args(target)
    open_left, open_right = left[-1:] == (Ellipsis,), right[-1:] == (Ellipsis,)
    if open_left or open_right:
        firsts = left[:1] if open_left else left
        wanted = right[:1] if open_right else right
        return all(assignable(a, b) for a in firsts for b in wanted)
    return len(left) == len(right) and all(map(assignable, left, right))

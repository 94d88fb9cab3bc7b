"""The names of port types in tree files, and which types fit which ports."""

from __future__ import annotations

from functools import reduce
from operator import or_

from momantu_bt.messages import VALUE_TYPES
from momantu_bt.values import kinds
from momantu_bt.values.kinds import ValueKind, ValueType, kind_of, without_none

_LIST_OF = "list of "


def parse_type(text: str) -> ValueType:
    """The Python type for a name in tree files: `text`, `list of number`, `pose2d or text`.

    Raises:
        KeyError: no type has this name; its argument is the unknown part of the name.
    """
    text = text.strip()
    depth = 0
    while text.startswith(_LIST_OF):
        text, depth = text[len(_LIST_OF) :].strip(), depth + 1
    options = [option.strip() for option in text.split(" or ")]
    unknown = [option for option in options if option not in VALUE_TYPES]
    if unknown:
        raise KeyError(unknown[0])
    found: ValueType = reduce(or_, (VALUE_TYPES[option] for option in options))
    for _ in range(depth):
        found = tuple[found, ...]
    return found


def label(type_: ValueType) -> str:
    """A type as tree files name it: "list of pose", "text or pose2d", "'a' or 'b'"."""
    return _label(kind_of(type_))


def _label(kind: ValueKind) -> str:
    match kind:
        case kinds.Anything():
            return "any"
        case kinds.Choice():
            return " or ".join(repr(value) for value in kind.values)
        case kinds.Either():
            return " or ".join(map(_label, without_none(kind)))
        case kinds.Items() | kinds.QueueOf():
            return _LIST_OF + _label(kind.item)
        case kinds.Fixed():
            return _list_label(kind.items)
        case kinds.Table():
            return f"mapping of {_label(kind.item)}"
    for name, known in VALUE_TYPES.items():
        if known is kind.type:
            return name
    match kind:
        case kinds.Enumeration():
            return " or ".join(repr(item.value) for item in kind.type)
        case kinds.Text():
            return "text"
        case _:
            return str(getattr(kind.type, "__name__", kind.type))


def _list_label(items: tuple[ValueKind, ...]) -> str:
    if all(item == items[0] for item in items):
        return f"list of {len(items)} {_label(items[0])}"
    return f"list of ({', '.join(map(_label, items))})"


def assignable(source: ValueType, target: ValueType) -> bool:
    """Whether a value of type `source` can fit a port of type `target`.

    Returns True when only the value can decide: for `any`, unions and choices of texts.
    """
    return _assignable(kind_of(source), kind_of(target))


def _assignable(source: ValueKind, target: ValueKind) -> bool:
    if source == target:
        return True
    match source, target:
        case (kinds.Anything() | kinds.Unknown(), _) | (_, kinds.Anything() | kinds.Unknown()):
            return True
        case kinds.Either(), _:
            return any(_assignable(option, target) for option in source.options)
        case _, kinds.Either():
            return any(_assignable(source, option) for option in target.options)
        case _, kinds.QueueOf():
            listed = kinds.Items(target.type, target.item)
            may_be = (listed, target.item)
            return source.type is str or any(_assignable(source, each) for each in may_be)
        case kinds.Choice(), _:
            return any(_assignable(kind_of(type(value)), target) for value in source.values)
        case _, kinds.Choice():
            return any(source.type is type(value) for value in target.values)
        case (kinds.Items() | kinds.Fixed(), _) | (_, kinds.Items() | kinds.Fixed()):
            return _lists(source, target)
        case kinds.Table(), kinds.Table():
            return _assignable(source.key, target.key) and _assignable(source.item, target.item)
        case _, kinds.Number():
            return isinstance(source, kinds.Number) and (target.type is float or source.type is int)
        case _, kinds.Text() | kinds.Enumeration():
            return _is_subclass(source.type, str)
        case _:
            return _is_subclass(source.type, target.type)


def _lists(source: ValueKind, target: ValueKind) -> bool:
    match source, target:
        case kinds.Fixed(), kinds.Fixed():
            return len(source.items) == len(target.items) and all(
                map(_assignable, source.items, target.items)
            )
        case ((kinds.Items() | kinds.Fixed()), (kinds.Items() | kinds.Fixed())):
            firsts = source.items if isinstance(source, kinds.Fixed) else (source.item,)
            wanted = target.items if isinstance(target, kinds.Fixed) else (target.item,)
            return all(_assignable(a, b) for a in firsts for b in wanted)
        case _:
            return False


def _is_subclass(source: ValueType, target: ValueType) -> bool:
    classes = isinstance(source, type) and isinstance(target, type)
    return classes and issubclass(source, target)

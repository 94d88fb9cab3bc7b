"""Port values in XML: what the text of an attribute means for a port of some type.

Attributes without a prefix are BehaviorTree.CPP's: `{key}`, `{@key}`, `{=}`, or else a text.
Attributes with `momantu:` hold the value in YAML, for all that BehaviorTree.CPP cannot say.
"""

from __future__ import annotations

import re
from typing import Any

from momantu_bt.formats.places import Place
from momantu_bt.formats.yaml.core import resolve
from momantu_bt.formats.yaml.reader import YamlSyntaxError
from momantu_bt.formats.yaml.values import Entries, Items, Raw
from momantu_bt.tree.files.port_values import KEY, port_value
from momantu_bt.tree.files.syntax import compose
from momantu_bt.tree.model import Literal, PortValue, Reference, Scope
from momantu_bt.tree.problems import Problems
from momantu_bt.values.kinds import (
    Choice,
    Enumeration,
    Text,
    Truth,
    ValueKind,
    ValueType,
    kind_of,
    without_none,
)

SAME_NAME = "{=}"
"""Wires a port to the key of its own name."""

_HALF_A_WIRE = re.compile(r"\{(@?[^\W\d]\w*)|(@?[^\W\d]\w*)\}|\$(@?[^\W\d]\w*)")
_POINTER = re.compile(r" *\{(.+)\} *", re.DOTALL)
_BOOLS = {"True": True, "TRUE": True, "1": True, "False": False, "FALSE": False, "0": False}
"""The texts that BehaviorTree.CPP reads as a bool, beside `true` and `false`."""


class WireError(ValueError):
    """A text in braces does not name a key; the message says what to write."""


def attribute_value(text: str, port: str, type_: ValueType) -> PortValue:
    """The value of an attribute without prefix.

    port: its name, for `{=}`. type_: the port's type; `object` if it is not known.

    Raises:
        WireError: braces around something that cannot be a key, or half a wire.
    """
    if text == SAME_NAME:
        return Reference(port)
    pointer = _POINTER.fullmatch(text)
    if pointer is not None:
        return _wire(pointer[1])
    _refuse_half_a_wire(text)
    if takes_text(type_):
        return Literal(text)
    if text in _BOOLS and all(isinstance(kind, Truth) for kind in without_none(kind_of(type_))):
        return Literal(_BOOLS[text])
    return Literal(_plain(text))


def _wire(key: str) -> Reference:
    root = key.startswith("@")
    name = key.removeprefix("@")
    if not KEY.fullmatch(name):
        raise WireError(f"{{{key}}} names no key: letters, digits and underscores, no digit first")
    return Reference(name, scope=Scope.ROOT if root else Scope.LOCAL)


def _refuse_half_a_wire(text: str) -> None:
    """Refuse `{key`, `key}` and YAML's `$key`. As texts they go into `momantu:port="…"`."""
    slipped = _HALF_A_WIRE.fullmatch(text)
    if slipped is not None:
        key = next(filter(None, slipped.groups()))
        raise WireError(f"{text!r} is not a wire: did you mean {{{key}}}?")


def takes_text(type_: ValueType) -> bool:
    """Whether a port of this type takes only texts. Then `5` is a text too."""
    return all(map(_is_text, without_none(kind_of(type_))))


def _is_text(kind: ValueKind) -> bool:
    match kind:
        case Choice(values=values):
            return all(isinstance(value, str) for value in values)
        case Enumeration(type=enum):
            return all(isinstance(item.value, str) for item in enum)
        case _:
            return isinstance(kind, Text)


def _plain(text: str) -> Any:
    """The value of `5`, `0.5`, `true` in YAML 1.2 if YAML writes it the same; else the text."""
    value = resolve(text)
    if isinstance(value, bool):
        return value
    if isinstance(value, int | float) and repr(value) == text:
        return value
    return text


def flow_value(text: str, port: str, place: Place, problems: Problems) -> PortValue | None:
    """The value of a prefixed attribute: YAML on one line; None if a problem was reported.

    place: where the text is in the file. Problems get places within the text if the file has it
    character by character, without entities.
    """
    try:
        raw = compose(text, place.file)
    except YamlSyntaxError as error:
        problem = error.problem
        where = _within(problem.place, place, text)
        problems.error(problem.code, where, problem.message, problem.hint)
        return None
    _move(raw, place, text)
    return port_value(raw, port, problems)


def _move(root: Raw, place: Place, text: str) -> None:
    """Turn places in the attribute into places in the file."""
    waiting, moved = [root], set[int]()
    while waiting:
        raw = waiting.pop()
        if id(raw) in moved:
            continue
        moved.add(id(raw))
        raw.place = _within(raw.place, place, text)
        if isinstance(raw, Items):
            waiting.extend(raw.items)
        elif isinstance(raw, Entries):
            for key, value in raw.entries:
                waiting.extend((key, value))


def _within(inner: Place, outer: Place, text: str) -> Place:
    if outer.length != len(text) or inner.line != 1 or inner.file != outer.file:
        return outer
    room = outer.length - (inner.column - 1)
    length = max(1, min(inner.length, room))
    return Place(outer.file, outer.line, outer.column + inner.column - 1, length)

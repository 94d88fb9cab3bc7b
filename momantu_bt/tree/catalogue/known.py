"""What is known about the keys of a blackboard at one point of a tree."""

from __future__ import annotations

import typing
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from functools import cache
from typing import Any

from momantu_bt.formats.places import Place
from momantu_bt.tree.model import Literal
from momantu_bt.values.convert import natural
from momantu_bt.values.kinds import Number, Record, Text, Truth, ValueType, kind_of, without_none
from momantu_bt.values.types import assignable


@dataclass(frozen=True, slots=True)
class Key:
    """A key that has a value.

    type: of the value. literals: every possible value, if all are literals in the file; else empty.
    place: where the key was written. either: alternatives with different types, when the ways that
    lead here write different things. choices: every possible value, if a node offered these to
    choose from, and nothing has written the key since.
    """

    type: ValueType
    place: Place
    literals: tuple[Literal, ...] = ()
    either: tuple[Key, ...] = ()
    choices: tuple[Literal, ...] = ()

    def misfits(self, type_: ValueType) -> Iterator[Key]:
        """The possible values that do not fit an expected type."""
        for key in self.either or (self,):
            if not assignable(key.type, type_):
                yield key


@dataclass(frozen=True, slots=True)
class Known:
    """The keys that surely have a value at a point. keys: None if the point is never reached."""

    keys: Mapping[str, Key] | None

    @property
    def reached(self) -> bool:
        """Whether this point can be reached at all."""
        return self.keys is not None

    def get(self, name: str) -> Key | None:
        """What is known about a key."""
        return None if self.keys is None else self.keys.get(name)

    def having(self, name: str, key: Key) -> Known:
        """A copy with one more key."""
        return self.having_all({name: key})

    def having_all(self, keys: Mapping[str, Key]) -> Known:
        """A copy with further keys."""
        return self if self.keys is None or not keys else Known({**self.keys, **keys})

    def rewritten(self, keys: Iterable[tuple[str, Key]]) -> Known:
        """A copy for a point where some keys that have a value may have been written again.

        The old value stays possible; a new one of a type that does not fit becomes an alternative.
        """
        if self.keys is None:
            return self
        having = dict(self.keys)
        for name, key in keys:
            old = having.get(name)
            if old is not None and old.choices and old.place != key.place:
                old = having[name] = replace(old, choices=())
            if old is not None and any(
                not assignable(key.type, k.type) for k in old.either or (old,)
            ):
                having[name] = _one_or_other(old, key)
        return Known(having)

    def lacking(self, names: Iterable[str]) -> Known:
        """A copy without some keys."""
        if self.keys is None:
            return self
        gone = self.keys.keys() & set(names)
        if not gone:
            return self
        return Known({name: key for name, key in self.keys.items() if name not in gone})


NEVER = Known(None)


def meet(*points: Known) -> Known:
    """What is known when the run has passed one of these points, but not which."""
    reached = [point.keys for point in points if point.keys is not None]
    if not reached:
        return NEVER
    common = reached[0]
    for keys in reached[1:]:
        if keys is not common:
            common = {n: _either(k, keys[n]) for n, k in common.items() if n in keys}
    return Known(common)


def both(*points: Known) -> Known:
    """What is known when the run has passed all of these points; later ones count more."""
    if not all(point.reached for point in points):
        return NEVER
    return Known({name: key for point in points for name, key in (point.keys or {}).items()})


def _either(left: Key, right: Key) -> Key:
    if left is right or left == right:
        return left
    if left.either or right.either:
        return _one_or_other(left, right)
    if assignable(left.type, right.type):
        return Key(right.type, right.place)
    if assignable(right.type, left.type):
        return Key(left.type, left.place)
    return _one_or_other(left, right)


def _one_or_other(left: Key, right: Key) -> Key:
    """The alternatives of both keys; each type once, with the place of its first write."""
    by_type: list[Key] = []
    for key in (*(left.either or (left,)), *(right.either or (right,))):
        if all(key.type != known.type for known in by_type):
            by_type.append(key)
    return Key(object, left.place, either=tuple(by_type))


def literal_type(value: Literal) -> ValueType:
    """The type of a literal that no port defines; a quantity such as `3 m` is a number."""
    plain = natural(value.value)
    return type(plain) if isinstance(plain, bool | int | float | str) else object


def part_type(type_: ValueType, parts: tuple[str, ...]) -> ValueType:
    """The type of a part of a value; `object` when it is unknown.

    Raises:
        KeyError: a type has no such part; the arguments are the type, the part and the valid ones.
    """
    for name in parts:
        match without_none(kind_of(type_)):
            case (Record(type=record),):
                known = _parts(record)
            case (Text() | Number() | Truth(),):
                known = {}
            case _:
                return object
        if name not in known:
            raise KeyError(type_, name, tuple(known))
        type_ = known[name]
    return type_


@cache
def _parts(type_: Any) -> dict[str, Any]:
    hints = typing.get_type_hints(type_)
    found = {field.name: hints.get(field.name, object) for field in fields(type_)}
    for name, value in vars(type_).items():
        if isinstance(value, property) and value.fget is not None:
            found[name] = typing.get_type_hints(value.fget).get("return", object)
    return found

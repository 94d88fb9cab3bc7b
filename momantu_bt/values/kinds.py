"""The kinds of values that a port can take.

A port's type is a Python annotation. `kind_of` turns it into one of the kinds below. Code that
handles types differently (labels, the checker, conversion, schemas, examples) matches on the kind
and never inspects an annotation. mypy reports a match that forgets a kind.
"""

from __future__ import annotations

import inspect
import types
from collections import abc
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from functools import cache, lru_cache
from typing import (
    Annotated,
    Any,
    Generic,
    Literal,
    TypeAlias,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

import numpy as np

ValueType: TypeAlias = Any
"""A Python type as ports declare it: a class, `X | None`, `tuple[X, ...]`, `Literal[...]`."""

_T = TypeVar("_T")


# Types for ports of built-in nodes only.


class ScriptText(str):
    """The type of a port that holds a script in canonical form (`&& || !`, bare names)."""


class CodeText(str):
    """The type of a port that holds a failure code."""


class Queue(Generic[_T]):
    """The type of a port that takes a list, one value, or a text of values separated by `;`."""


# The kinds.


@dataclass(frozen=True, slots=True)
class _Kind:
    """The base of the kinds. type: the annotation from which it was made."""

    type: ValueType


class Anything(_Kind):
    """`Any` or `object`: every value fits."""

    __slots__ = ()


class Unknown(_Kind):
    """A type that cannot be checked, such as a type variable or a protocol: every value fits."""

    __slots__ = ()


class Nothing(_Kind):
    """The value None."""

    __slots__ = ()


class Truth(_Kind):
    """A bool."""

    __slots__ = ()


class Number(_Kind):
    """An int or a float, see `type`. A float may have a unit; the port holds it."""

    __slots__ = ()


class Text(_Kind):
    """A str, or a subclass of it such as `CodeText`."""

    __slots__ = ()


class Enumeration(_Kind):
    """A member of an Enum."""

    __slots__ = ()


class Array(_Kind):
    """A NumPy array."""

    __slots__ = ()


class Record(_Kind):
    """A dataclass; see `parts_of`."""

    __slots__ = ()


class Instance(_Kind):
    """An instance of any other class."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class Choice(_Kind):
    """One of the values of a `Literal`."""

    values: tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class Items(_Kind):
    """A list of any length. Its values are tuples."""

    item: ValueKind


@dataclass(frozen=True, slots=True)
class Fixed(_Kind):
    """A list of fixed length, with a kind for each item. Its values are tuples."""

    items: tuple[ValueKind, ...]


@dataclass(frozen=True, slots=True)
class QueueOf(_Kind):
    """A `Queue`. Its values are tuples."""

    item: ValueKind


@dataclass(frozen=True, slots=True)
class Table(_Kind):
    """A mapping. Its values are read-only."""

    key: ValueKind
    item: ValueKind


@dataclass(frozen=True, slots=True)
class Either(_Kind):
    """A union: `A | B`, `A | None`."""

    options: tuple[ValueKind, ...]


ValueKind: TypeAlias = (
    Anything
    | Unknown
    | Nothing
    | Truth
    | Number
    | Text
    | Enumeration
    | Array
    | Record
    | Instance
    | Choice
    | Items
    | Fixed
    | QueueOf
    | Table
    | Either
)

ANYTHING = Anything(object)


@dataclass(frozen=True, slots=True)
class Part:
    """One field of a dataclass.

    unit: the SI unit of a number. required: it has no default. least, most: bounds of a number, in
    its unit. names: what a text names, as for a port.
    """

    name: str
    kind: ValueKind
    unit: str | None
    required: bool
    least: float | None = None
    most: float | None = None
    names: str | None = None


def kind_of(type_: ValueType) -> ValueKind:
    """The kind of a type; results are cached."""
    return _of_class(type_) if isinstance(type_, type) else _of_form(_Form(type_))


def is_type(annotation: ValueType) -> bool:
    """Whether an annotation is a type that values can be checked against."""
    return isinstance(annotation, type) or not isinstance(kind_of(annotation), Unknown)


def without_none(kind: ValueKind) -> tuple[ValueKind, ...]:
    """The alternatives of a union except None, or the kind alone."""
    if not isinstance(kind, Either):
        return (kind,)
    return tuple(option for option in kind.options if not isinstance(option, Nothing))


@cache
def parts_of(type_: type) -> tuple[Part, ...]:
    """The fields of a dataclass that its constructor takes, in order."""
    hints = get_type_hints(type_)
    taken = inspect.signature(type_).parameters
    empty = inspect.Parameter.empty
    return tuple(
        Part(
            field.name,
            kind_of(hints[field.name]),
            field.metadata.get("unit"),
            taken[field.name].default is empty,
            field.metadata.get("least"),
            field.metadata.get("most"),
            field.metadata.get("names"),
        )
        for field in fields(type_)
        if field.init and field.name in taken
    )


@cache
def _of_class(type_: type) -> ValueKind:
    if type_ in _EXACTLY:
        return _EXACTLY[type_]
    if issubclass(type_, Enum):
        return Enumeration(type_)
    if issubclass(type_, str):
        return Text(type_)
    if issubclass(type_, np.ndarray):
        return Array(type_)
    if is_dataclass(type_):
        return Record(type_)
    return Instance(type_) if _is_checkable(type_) else Unknown(type_)


_LISTS = (tuple, list, abc.Sequence, abc.MutableSequence)
_MAPPINGS = (dict, abc.Mapping, abc.MutableMapping, types.MappingProxyType)
_EXACTLY: Mapping[Any, ValueKind] = {
    object: ANYTHING,
    Any: ANYTHING,
    bool: Truth(bool),
    int: Number(int),
    float: Number(float),
    types.NoneType: Nothing(types.NoneType),
    Queue: QueueOf(Queue, ANYTHING),
    **{each: Items(each, ANYTHING) for each in _LISTS},
    **{each: Table(each, ANYTHING, ANYTHING) for each in _MAPPINGS},
}
"""Classes for which only the class itself has the kind, not its subclasses."""


def _is_checkable(type_: type) -> bool:
    """Whether `isinstance` accepts the type; it rejects most protocols."""
    try:
        isinstance(None, type_)
    except TypeError:
        return False
    return True


@dataclass(frozen=True, slots=True, eq=False)
class _Form:
    """A cache key for a type that is not a class.

    It compares by identity, as `A | B` and `B | A` are equal but need different kinds.
    """

    type: ValueType

    def __hash__(self) -> int:
        return id(self.type)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Form) and self.type is other.type


@lru_cache(maxsize=1024)
def _of_form(form: _Form) -> ValueKind:
    type_ = form.type
    if type_ is None:
        return Nothing(types.NoneType)
    head: Any = get_origin(type_)
    arguments = get_args(type_)
    if not arguments:
        return kind_of(head) if isinstance(head, type) else Unknown(type_)
    if head is Annotated:
        return kind_of(arguments[0])
    if head is Literal:
        return Choice(type_, arguments)
    if head is Union or head is types.UnionType:
        return Either(type_, tuple(map(kind_of, arguments)))
    if head is Queue:
        return QueueOf(type_, kind_of(arguments[0]))
    if head is tuple and arguments[1:] != (Ellipsis,):
        return Fixed(type_, tuple(map(kind_of, arguments)))
    if head in _LISTS:
        return Items(type_, kind_of(arguments[0]))
    if head in _MAPPINGS:
        return Table(type_, *map(kind_of, arguments))
    return kind_of(head) if isinstance(head, type) else Unknown(type_)

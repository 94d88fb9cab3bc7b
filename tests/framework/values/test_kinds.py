"""Each type is of one kind, with its parts, however it is spelled; walkers know every kind."""

from __future__ import annotations

import typing
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from types import MappingProxyType
from typing import Annotated, Any, Literal, Optional, Protocol, TypeVar

import numpy as np
import pytest
from numpy.typing import NDArray

from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.messages import ObjectClass
from momantu_bt.skill import Port
from momantu_bt.testing.example_inputs import NoExample, of_type
from momantu_bt.tree.show.schema_values import value_schema
from momantu_bt.values import kinds
from momantu_bt.values.admit import admit
from momantu_bt.values.convert import convert
from momantu_bt.values.kinds import (
    ANYTHING,
    CodeText,
    Queue,
    ValueKind,
    ValueType,
    kind_of,
    parts_of,
    without_none,
)
from momantu_bt.values.types import assignable, label


class Colour(Enum):
    """An enumeration for tests."""

    RED = "red"


class Moves(Protocol):
    """A protocol that `isinstance` does not take."""


INT, FLOAT, TEXT = kinds.Number(int), kinds.Number(float), kinds.Text(str)
T = TypeVar("T")
SPELLED: list[tuple[ValueType, ValueKind]] = [
    (Any, ANYTHING),
    (object, ANYTHING),
    (None, kinds.Nothing(type(None))),
    (bool, kinds.Truth(bool)),
    (int, INT),
    (CodeText, kinds.Text(CodeText)),
    (Colour, kinds.Enumeration(Colour)),
    (np.ndarray, kinds.Array(np.ndarray)),
    (NDArray[np.float64], kinds.Array(np.ndarray)),
    (Pose2D, kinds.Record(Pose2D)),
    (Annotated[Pose2D, "in the map"], kinds.Record(Pose2D)),
    (set, kinds.Instance(set)),
    (set[int], kinds.Instance(set)),
    (Callable[[int], str], kinds.Instance(Callable)),
    (Literal["a", 1], kinds.Choice(Literal["a", 1], ("a", 1))),
    (list, kinds.Items(list, ANYTHING)),
    (typing.List, kinds.Items(list, ANYTHING)),  # noqa: UP006 a port's type as well
    (tuple[int, ...], kinds.Items(tuple[int, ...], INT)),
    (Sequence[int], kinds.Items(Sequence[int], INT)),
    (tuple[int, str], kinds.Fixed(tuple[int, str], (INT, TEXT))),
    (Queue[int], kinds.QueueOf(Queue[int], INT)),
    (dict, kinds.Table(dict, ANYTHING, ANYTHING)),
    (Mapping[str, float], kinds.Table(Mapping[str, float], TEXT, FLOAT)),
    (Optional[int], kinds.Either(Optional[int], (INT, kinds.Nothing(type(None))))),  # noqa: UP045
    (int | str, kinds.Either(int | str, (INT, TEXT))),
    (T, kinds.Unknown(T)),
    (Moves, kinds.Unknown(Moves)),
    ("Pose2D", kinds.Unknown("Pose2D")),
]


@pytest.mark.parametrize(("type_", "expected"), SPELLED, ids=str)
def test_the_kind_of_a_type(type_: ValueType, expected: ValueKind) -> None:
    assert kind_of(type_) == expected


def test_there_is_an_example_of_each_kind() -> None:
    assert {type(kind) for _, kind in SPELLED} == set(typing.get_args(ValueKind))


def test_the_order_of_alternatives_is_that_of_the_port() -> None:
    assert label(str | Pose2D) == "text or pose2d"
    assert label(Pose2D | str) == "pose2d or text"
    assert label(tuple[Literal["b", "a"], ...]) == "list of 'b' or 'a'"
    assert label(tuple[Literal["a", "b"], ...]) == "list of 'a' or 'b'"


def test_none_is_left_out_of_the_alternatives() -> None:
    assert without_none(kind_of(int | None)) == (INT,)
    assert without_none(INT) == (INT,)


@dataclass(frozen=True)
class Shelf:
    """A dataclass for tests."""

    height: float = field(metadata={"unit": "m"})
    boards: int = 1
    made: bool = field(init=False, default=True)


def test_parts_are_what_the_constructor_takes() -> None:
    assert parts_of(Shelf) == (
        kinds.Part("height", FLOAT, "m", required=True),
        kinds.Part("boards", INT, None, required=False),
    )
    assert not any(part.required for part in parts_of(Transform))


@pytest.mark.parametrize("type_", [type_ for type_, _ in SPELLED], ids=str)
def test_an_example_of_a_type_passes_every_way_in_and_out(type_: ValueType) -> None:
    try:
        value = of_type(type_)
    except NoExample:
        return
    port = Port("p", "in", type_, "")
    assert repr(convert(value, port)) == repr(value)
    assert repr(admit(value, port)) == repr(value)
    assert label(type_)
    assert value_schema(port, {})
    assert assignable(type_, type_)


def test_a_mapping_of_values_is_converted_item_by_item_and_read_only() -> None:
    port = Port("sizes", "in", dict[str, float], "", unit="m")
    found = convert({"can": "66 mm", "mug": 1}, port)
    assert found == {"can": 0.066, "mug": 1.0}
    assert isinstance(found, MappingProxyType)
    with pytest.raises(ValueError, match="key 'can': 'wide' does not fit; expected number in m"):
        convert({"can": "wide"}, port)
    with pytest.raises(ValueError, match="a list does not fit; expected mapping of number"):
        convert([1], port)


@pytest.mark.parametrize(
    ("source", "target", "expected"),
    [
        (list[int], tuple[float, ...], True),
        (tuple[str, ...], list[int], False),
        (dict[str, int], Mapping[str, float], True),
        (dict[str, str], dict[str, float], False),
        (dict[str, str], ObjectClass, False),
        (T, int, True),
    ],
)
def test_what_may_flow(source: ValueType, target: ValueType, expected: bool) -> None:
    assert assignable(source, target) is expected

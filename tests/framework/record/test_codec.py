"""Values survive JSON with their types and their last bit, whatever they are."""

import json
import math
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from momantu_bt.engine.encode import encode
from momantu_bt.failure import FailureValue
from momantu_bt.geometry import Pose, Pose2D, Transform
from momantu_bt.messages import BaseVelocity, DetectedObject
from momantu_bt.record.codec import CodecError, Opaque, dumps, from_json, to_json, to_text
from momantu_bt.record.codec_types import find_type
from momantu_bt.skill import MISSING


class Colour(Enum):
    RED = 1


class Pair(NamedTuple):
    left: int
    right: object


@dataclass(frozen=True, slots=True)
class Thing:
    size: float
    inner: object


NUMBERS = st.floats() | st.integers() | st.booleans() | st.none()
KEYS = st.text() | st.just("$type") | st.just("")
ARRAYS = hnp.arrays(
    st.sampled_from(["<f8", "<f4", "|u1", "<i8", "|b1"]), hnp.array_shapes(min_dims=0, max_side=6)
)
PLAIN = NUMBERS | st.text() | st.binary() | st.just(Colour.RED) | ARRAYS | st.just(MISSING)
VALUES = st.recursive(
    PLAIN,
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.lists(inner, max_size=3).map(tuple)
        | st.dictionaries(KEYS, inner, max_size=3)
        | st.dictionaries(KEYS, inner, max_size=3).map(MappingProxyType)
        | st.builds(Thing, st.floats(), inner)
        | st.builds(Pair, st.integers(), inner)
    ),
    max_leaves=8,
)


def there_and_back(value):
    return from_json(json.loads(dumps(to_json(value))))


def same(left, right):
    if type(left) is not type(right):
        return False
    if isinstance(left, float):
        return left == right or (math.isnan(left) and math.isnan(right))
    if isinstance(left, np.ndarray):
        return (
            left.dtype == right.dtype
            and left.shape == right.shape
            and encode(left) == encode(right)
        )
    if isinstance(left, list | tuple):
        return len(left) == len(right) and all(map(same, left, right))
    if isinstance(left, dict | MappingProxyType):
        return left.keys() == right.keys() and all(same(left[k], right[k]) for k in left)
    if isinstance(left, Thing):
        return same((left.size, left.inner), (right.size, right.inner))
    return left == right


@given(value=VALUES)
def test_any_value_comes_back_as_it_was(value):
    assert same(there_and_back(value), value)


@given(numbers=st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4).filter(any))
def test_a_quaternion_is_not_brought_to_length_one_again(numbers):
    try:
        pose = Transform((1.0, 2.0, 3.0), numbers)
    except ValueError:
        return
    back = there_and_back(pose)
    assert encode(back) == encode(pose)
    assert not back.position.flags.writeable


def test_what_is_on_the_board_survives():
    pose = Pose(Transform((0.1, 0.2, 0.3)), "odom", 1.5)
    can = DetectedObject("can", pose, (0.07, 0.07, 0.13), "cylinder", 0.9, 0.7)
    cause = FailureValue("OH", "why", MappingProxyType({"n": math.inf}), "leaf", "t.yaml:3")
    failure = FailureValue("OH", "why", cause=cause, beside=(cause,))
    for value in (can, failure, (can, Pose2D(1.0, -0.0)), Path("a/b"), {3: can}, {1, 2}):
        assert there_and_back(value) == value


@given(
    value=VALUES
    | st.builds(Pose2D, st.floats(), st.floats() | st.integers())
    | st.builds(BaseVelocity, st.floats(), st.floats())
    | st.just(Colour)
    | st.just(Pose2D)
)
def test_the_quick_way_to_text_is_the_same_text(value):
    assert to_text(value) == dumps(to_json(value))


class Odd:
    def __repr__(self):
        raise RuntimeError("no")


def deep(levels):
    value = ()
    for _ in range(levels):
        value = (value,)
    return value


@pytest.mark.parametrize("value", [object(), lambda: 0, Odd(), 1j, np.array([object()]), deep(500)])
def test_what_json_cannot_hold_is_told_as_text(value):
    back = there_and_back(value)
    assert "0x" not in repr(back)
    while isinstance(back, tuple):
        (back,) = back
    assert isinstance(back, Opaque)
    assert there_and_back(back) == back


def test_sets_have_one_order():
    assert dumps(to_json({"b", "a", "c"})) == '{"$set":["a","b","c"]}'


@pytest.mark.parametrize(
    "data",
    [
        {"$no": 1},
        {"$array": "<f8", "shape": [3], "data": [1.0]},
        {"$array": "|O", "shape": [1], "data": "AAAA"},
        {"$array": "<f8", "shape": [1], "data": "!"},
        {"$type": 5},
        {"$mapping": [1]},
        json.loads("[" * 400 + "]" * 400),
    ],
)
def test_other_data_is_refused(data):
    with pytest.raises(CodecError, match="not a value of a record"):
        from_json(data)


def test_types_that_are_not_here_become_text_and_import_nothing():
    gone = from_json({"$type": "momantu_bt.geometry:Gone", "x": 1})
    assert gone == Opaque("momantu_bt.geometry:Gone", '{"x":1}')
    assert from_json({"$type": "momantu_bt.geometry:Pose2D", "x": 1.0}).text == '{"x":1.0}'
    assert from_json({"$enum": "antigravity:Colour", "name": "RED"}) == Opaque(
        "antigravity:Colour", "RED"
    )
    assert find_type("antigravity:x") is None
    assert find_type("os:path") is None
    assert find_type("momantu_bt.geometry:Pose2D") is Pose2D

"""Values into ports: what fits, what is refused with what would be valid, and types along wires."""

from enum import Enum
from typing import Any, Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.geometry import Pose, Pose2D, Transform
from momantu_bt.messages import VALUE_TYPES, ObjectClass
from momantu_bt.skill import Port
from momantu_bt.values.convert import convert, natural
from momantu_bt.values.kinds import Queue
from momantu_bt.values.types import assignable, label, parse_type
from momantu_bt.values.words import ConversionError, render


class Colour(Enum):
    """An enumeration for tests."""

    RED = "red"
    BLUE = "blue"


def into(value: Any, type_: Any, unit: str | None = None) -> Any:
    """A value through a port of this type."""
    return convert(value, Port("p", "in", type_, "", unit=unit))


HERE = Pose(Transform(), "odom", 0.0)


@pytest.mark.parametrize(
    ("value", "type_", "unit", "expected"),
    [
        (3, float, "m", 3.0),
        ("3 cm", float, "m", 0.03),
        ("3 cm", float | None, "m", 0.03),
        (None, float | None, "m", None),
        (3.0, int, None, 3),
        (True, bool, None, True),
        ("a", str, None, "a"),
        ("a", str | Pose2D, None, "a"),
        ({"x": 1, "y": "2 cm"}, str | Pose2D, None, Pose2D(1.0, 0.02)),
        (["1 cm", 2], tuple[float, ...], "m", (0.01, 2.0)),
        ([1, 2], tuple[int, int], None, (1, 2)),
        ([], tuple[Pose, ...], None, ()),
        ("b", Literal["a", "b"], None, "b"),
        ("red", Colour, None, Colour.RED),
        (
            {"category": "can", "diameter": "66 mm"},
            ObjectClass,
            None,
            ObjectClass("can", diameter=0.066),
        ),
        (HERE, Pose, None, HERE),
        ("66 mm", object, None, 0.066),
        ("010", int, None, 10),
        ("2.50", float, None, 2.5),
        ("2.50", float, "m", 2.5),
    ],
)
def test_what_fits(value: Any, type_: Any, unit: str | None, expected: Any) -> None:
    found = into(value, type_, unit)
    assert found == expected
    assert type(found) is type(expected)


def test_a_pose_is_written_as_lists() -> None:
    pose = into({"transform": {"position": ["20 cm", 0, 1]}, "frame": "map", "stamp": 0}, Pose)
    assert pose.position.tolist() == [0.2, 0.0, 1.0]
    assert pose.transform.quaternion.tolist() == [1.0, 0.0, 0.0, 0.0]
    assert not pose.position.flags.writeable


@pytest.mark.parametrize("position", [3, "x", [1, "x", 2], [1, None], [[1, 2], [3]], [".inf"]])
def test_what_is_no_list_of_numbers(position: Any) -> None:
    with pytest.raises(ConversionError, match="field 'position'"):
        into({"position": position}, Transform)


def test_a_list_of_another_length_than_the_types() -> None:
    with pytest.raises(ConversionError, match="Transform: "):
        into({"position": [1, 2]}, Transform)


@pytest.mark.parametrize(
    ("value", "type_", "message"),
    [
        ("no", bool, "did you mean false"),
        (1, bool, "not true or false"),
        (True, int, "expected int"),
        (True, float, "expected number"),
        ("three", int, "expected int"),
        ("2.50", int, "not a whole number"),
        ("3 m", int, "bare whole number"),
        (float("inf"), int, "not a whole number"),
        ("reb", Colour, "did you mean red"),
        ("x", Literal["left", "right"], "left, right"),
        ("x", tuple[int, ...], "is not a list"),
        ([1], tuple[int, int], "expected list of 2 int"),
        ([1, "x"], tuple[int, ...], "item 2 of the list"),
        (
            {"category": "can", "diameter": "3 s"},
            ObjectClass,
            "field 'diameter'.*expected a length",
        ),
        ({"diameter": 1}, ObjectClass, "needs the field 'category'"),
        ("can", ObjectClass, "expected object_class {category"),
        ("here", Pose, "expected pose"),
        (5, str, 'write "5" in quotes'),
        (None, str, "nothing does not fit"),
    ],
)
def test_what_is_refused(value: Any, type_: Any, message: str) -> None:
    with pytest.raises(ConversionError, match=message):
        into(value, type_)


_PLAIN = st.one_of(st.text(max_size=8), st.integers(-9, 9), st.floats(-9, 9), st.booleans())
_TYPES = st.sampled_from(
    [str, int, float, bool, str | Pose2D, tuple[float, ...], ObjectClass, Pose, object, Colour]
)


@given(st.recursive(_PLAIN, lambda s: st.lists(s, max_size=3), max_leaves=5), _TYPES)
def test_converting_twice_changes_nothing(value: Any, type_: Any) -> None:
    try:
        once = into(value, type_)
    except ConversionError:
        return
    assert into(once, type_) == once


def test_natural_values_are_immutable() -> None:
    value = natural({"a": ["1 cm", {"b": "5 apples"}], "c": "2 min"})
    assert value["a"][0] == 0.01
    assert value["a"][1]["b"] == "5 apples"
    assert value["c"] == 120.0
    with pytest.raises(TypeError):
        value["c"] = 1


def test_text_from_parts() -> None:
    assert render(["n is ", 3, ", x ", 0.5, ", ", True]) == "n is 3, x 0.5, true"


@pytest.mark.parametrize(
    ("source", "target", "expected"),
    [
        (int, float, True),
        (float, int, False),
        (bool, int, False),
        (str, float, False),
        (object, Pose, True),
        (Pose, object, True),
        (Pose, Pose | None, True),
        (Pose | None, Pose, True),
        (Pose, str | Pose2D, False),
        (tuple[Pose, ...], tuple[Pose, ...], True),
        (tuple[Pose, ...], tuple[Pose2D, ...], False),
        (tuple[int, int], tuple[float, ...], True),
        (tuple[int, int], tuple[int, int, int], False),
        (tuple[Pose, ...], Pose, False),
        (str, Literal["a", "b"], True),
        (Literal["a"], str, True),
        (str, Colour, True),
        (tuple, tuple[int, ...], True),
    ],
)
def test_what_may_flow(source: Any, target: Any, expected: bool) -> None:
    assert assignable(source, target) is expected


@given(st.sampled_from(sorted(VALUE_TYPES)), st.integers(0, 3))
def test_a_type_is_known_by_its_label(name: str, depth: int) -> None:
    text = "list of " * depth + name
    assert label(parse_type(text)) == text
    assert assignable(parse_type(text), parse_type(text))


@pytest.mark.parametrize(
    ("value", "item", "expected"),
    [
        ("1;2;3", int, (1, 2, 3)),
        ("1; 2;", int, (1, 2)),
        ("", int, ()),
        (7, int, (7,)),
        ([1, 2], float, (1.0, 2.0)),
        ("1.5;2", float, (1.5, 2.0)),
        ("a; b", str, ("a", " b")),
        (5, str, ("5",)),
        ("true;0;FALSE", bool, (True, False, False)),
        ((), bool, ()),
    ],
)
def test_a_queue_is_a_list_one_value_or_a_text_of_several(
    value: Any, item: type, expected: tuple[Any, ...]
) -> None:
    found = into(value, Queue[item])
    assert found == expected
    assert [type(each) for each in found] == [item] * len(found)


@pytest.mark.parametrize(
    ("value", "item"), [("1;x", int), ("1;;2", int), ("2", bool), (None, str), ([1], str)]
)
def test_what_no_queue_can_be_made_of(value: Any, item: type) -> None:
    with pytest.raises(ConversionError):
        into(value, Queue[item])


def test_what_may_flow_into_a_queue() -> None:
    assert label(Queue[int]) == "list of int"
    for fits in (str, int, tuple[int, ...], object):
        assert assignable(fits, Queue[int])
    for other in (Pose, tuple[str, ...], bool):
        assert not assignable(other, Queue[int])

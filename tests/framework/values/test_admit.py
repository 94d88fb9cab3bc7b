"""Values at ports: which fit which type, and that what is frozen can no longer change."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Optional

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.engine.status import RUNNING, Status
from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose, Pose2D, Transform
from momantu_bt.skill import In, Out, Port, Run, Skill
from momantu_bt.testing import run_skill
from momantu_bt.values.admit import admit, admit_output
from momantu_bt.values.contents import freeze, nan_in

HERE = Pose2D(1.0, 2.0, 0.0)
FITTING = [
    (3, int, True),
    (3.0, int, False),
    (3, float, True),
    ((3,), tuple[float, ...], True),
    (True, int, False),
    (True, float, False),
    (True, bool, True),
    (0, bool, False),
    ("a", str, True),
    (None, None, True),
    (None, str, False),
    (None, Optional[str], True),  # noqa: UP045 the older spelling is a port's type as well
    (None, str | None, True),
    (3, str | None, False),
    (True, int | None, False),
    ("up", Literal["up", "down"], True),
    ("left", Literal["up", "down"], False),
    (1, Literal[True], False),
    ((1, 2), tuple[int, ...], True),
    ((), tuple[int, ...], True),
    ((1, "2"), tuple[int, ...], False),
    ((1, "2"), tuple[int, str], True),
    ((1,), tuple[int, str], False),
    ([1], tuple[int], True),
    ((1, 2), list[int], True),
    ((1, True), list[int], False),
    ((HERE,), list[Pose2D], True),
    (HERE, Pose2D, True),
    (HERE, Annotated[Pose2D, "in the map"], True),
    ({"a": 1}, dict[str, int], True),
    ({"a": "x"}, dict[str, int], False),
    ({"a": 1}, Mapping[str, int], True),
    ({"a": 1}, dict, True),
    ([1], list, True),
    ((1,), tuple, True),
    ("ab", list, False),
    (RUNNING, Status, True),
    (np.zeros(2), np.ndarray, True),
    (HERE, Any, True),
    (HERE, object, True),
]


def fits(value, kind):
    try:
        admit(value, Port("p", "out", kind, ""))
    except Failure:
        return False
    return True


@pytest.mark.parametrize(("value", "kind", "expected"), FITTING, ids=str)
def test_which_values_fit_which_types(value, kind, expected):
    assert fits(value, kind) is expected


VALUES = st.recursive(
    st.none() | st.integers() | st.text(max_size=3) | st.builds(np.zeros, st.integers(0, 3)),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=8,
)


def changeable(value):
    """Whether anything in a value can still be changed."""
    if isinstance(value, np.ndarray):
        return value.flags.writeable
    if isinstance(value, list | dict):
        return True
    if isinstance(value, tuple):
        return any(map(changeable, value))
    if isinstance(value, Mapping):
        return any(map(changeable, value.values()))
    return False


@given(value=VALUES)
def test_nothing_in_a_frozen_value_can_be_changed_and_freezing_twice_is_freezing_once(value):
    frozen = freeze(value)
    assert not changeable(frozen)
    again = freeze(frozen)
    assert type(again) is type(frozen)
    assert repr(again) == repr(frozen)


def test_a_wrong_value_is_told_with_what_was_expected_and_shown_short():
    with pytest.raises(Failure) as wrong:
        admit("x" * 1000, Port("pose", "in", Pose2D | None, ""))
    assert wrong.value.code == "WRONG_TYPE"
    assert dict(wrong.value.value.data) == {
        "port": "pose",
        "got": "str",
        "expected": "momantu_bt.geometry.Pose2D | None",
    }
    assert len(str(wrong.value)) < 200


@given(value=st.integers(-(2**40), 2**40))
def test_a_whole_number_is_a_number_where_one_is_asked(value):
    for kind in (float, float | None, Literal["any"] | float):
        admitted = admit(value, Port("x", "in", kind, ""))
        assert type(admitted) is float
        assert admitted == value


class Sort(Skill):
    """Takes and gives containers."""

    names: list = In(doc="a list")
    sizes: dict[str, float] = In(doc="by name")
    order: list[str] = Out(doc="names by size")
    table: dict = Out(doc="the same as it came")

    def run(self, robot) -> Run:
        yield "sorting"
        self.order = sorted(self.names, key=self.sizes.__getitem__)
        self.table = dict(self.sizes)


def test_lists_and_mappings_pass_through_ports():
    given_sizes = {"can": 2.0, "mug": 1.0}
    result = run_skill(Sort, inputs={"names": ["can", "mug"], "sizes": given_sizes})
    assert result.status == "SUCCESS", result.explain()
    assert result.outputs["order"] == ("mug", "can")
    assert result.outputs["table"] == given_sizes
    assert not changeable(result.outputs["table"])


NAN = float("nan")


@given(st.integers(0, 5), st.booleans())
def test_a_nan_is_found_wherever_it_is(where, there):
    number = NAN if there else 1.0
    value = [
        number,
        (1.0, (number,)),
        {"a": [2, {"b": number}]},
        np.array([[1.0, number]]),
        Pose(Transform((1.0, number, 0.0)), "odom", 2.0),
        Pose2D(number, 0.0),
    ][where]
    way = [(), ("1", "0"), ("a", "1", "b"), (), ("transform", "position"), ("x",)][where]
    assert nan_in(value) == (way if there else None)


def test_an_output_with_a_nan_is_refused_and_says_where():
    port = Port("seen", "out", Pose, "where")
    with pytest.raises(Failure, match=r"seen\.transform\.position is NaN") as caught:
        admit_output(Pose(Transform((NAN, 0.0, 0.0)), "odom", 0.0), port)
    assert caught.value.code == "WRONG_TYPE"
    assert admit_output(float("inf"), Port("far", "out", float, "")) == float("inf")
    assert admit_output([1, 2], Port("list", "out", tuple[int, ...], "")) == (1, 2)


def test_a_value_that_holds_itself_has_an_end():
    ring = []
    ring.append(ring)
    assert nan_in(ring) is None

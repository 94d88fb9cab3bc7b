"""The JSON Schema of a quantity accepts what its reader accepts, and hardly anything else."""

from typing import Any

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

from momantu_bt.descriptions.quantities import (
    UNITS_KEY,
    Angle,
    AngularAcceleration,
    AngularSpeed,
    Force,
    JointAcceleration,
    JointPosition,
    JointSpeed,
    Length,
    LinearAcceleration,
    LinearSpeed,
    Mass,
    Size,
    Time,
)

KINDS = (
    *(Length, Size, Angle, Mass, Force, Time),
    *(LinearSpeed, AngularSpeed, LinearAcceleration, AngularAcceleration),
    *(JointPosition, JointSpeed, JointAcceleration),
)
WORDS = st.one_of(
    st.floats(-10, 10),
    st.integers(-3, 3),
    st.builds(
        "{}{}{}".format,
        st.sampled_from(["0.5", "2", "-1", ".3", "1e2", "1.", ".", "", "x"]),
        st.sampled_from(["", " ", "  "]),
        st.sampled_from(["m", "cm", "kg", "rad", "deg", "N", "s", "m/s", "rad/s2", "", "k"]),
    ),
    st.sampled_from([None, True, [1], {}]),
)


def accepted(kind: Any, value: object) -> bool:
    try:
        TypeAdapter(kind).validate_python(value)
    except ValidationError:
        return False
    return True


def refined(kind: Any) -> jsonschema.Draft202012Validator:
    return jsonschema.Draft202012Validator(TypeAdapter(kind).json_schema())


@pytest.mark.parametrize("kind", KINDS)
@given(value=WORDS)
def test_schema_and_reader_agree(kind: Any, value: object) -> None:
    valid, read = refined(kind).is_valid(value), accepted(kind, value)
    if isinstance(value, str):
        # it knows no sign of a text: a pattern that told "0 m" from "0.1 m" would be unreadable
        assert valid or not read
    else:
        assert valid == read


@pytest.mark.parametrize("text", ["2", "m", "2 kg", "x m", ". m", "2 m m"])
def test_a_text_without_number_or_unit_is_refused(text: str) -> None:
    assert not refined(Length).is_valid(text)


@pytest.mark.parametrize(("kind", "units"), [(Length, ["m", "cm", "mm"]), (Angle, ["rad", "deg"])])
def test_units_are_told(kind: Any, units: list[str]) -> None:
    assert TypeAdapter(kind).json_schema()[UNITS_KEY] == units

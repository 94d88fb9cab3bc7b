"""A description's mistakes are told at their places; its quantities are read in SI units."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from momantu_bt.descriptions.quantities import JointPosition, JointSpeed, Length
from momantu_bt.descriptions.reading import DescriptionError, Reading, read_text
from momantu_bt.descriptions.validation import checked

FILE = Path("thing.yaml")


class Wheel(BaseModel):
    model_config = ConfigDict(extra="forbid")
    radius: Length
    name: str = ""


class Cart(BaseModel):
    model_config = ConfigDict(extra="forbid")
    wheels: dict[str, Wheel] = {}
    spare: Wheel | None = None


def cart(text: str) -> Cart:
    return checked(Reading(FILE, text, DescriptionError), Cart, DescriptionError)


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("wheels: {left: {radus: 5 cm}}", "1:17", "did you mean 'radius'"),
        (
            "wheels:\n  left:\n    radius: 5 kg",
            "3:13",
            "'5 kg' is a mass; expected a length, in: mm, cm, m",
        ),
        ("wheels: {left: {}}", "1:16", "wheels.left needs a key 'radius'"),
        ("spare: {radius: 1, nam: x}", "1:20", "did you mean 'name'"),
        ("wheels: [", "1:10", "not YAML"),
        ("", "1:1", "the file is empty"),
        ("spare: {radius: 1}\nspare: {radius: 1}", "2:1", "here twice; first in line 1"),
        ("wheels: " + "[" * 30 + "]" * 30, "1:28", "levels deep"),
    ],
)
def test_a_mistake_is_told_at_its_place(text: str, place: str, words: str) -> None:
    with pytest.raises(DescriptionError, match=rf"^thing.yaml:{place}: .*{words}"):
        cart(text)


def test_aliases_of_aliases_do_not_fill_the_memory() -> None:
    lines = ["a0: &a0 [1, 1]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 15)]
    with pytest.raises(DescriptionError, match="more than 100000 values"):
        cart("\n".join(lines))


def test_every_problem_is_told_in_order_with_a_caret() -> None:
    with pytest.raises(DescriptionError) as caught:
        cart("wheels:\n  a: {radius: x}\n  b: {radius: 5 cn}")
    lines = str(caught.value).splitlines()
    places = [line.partition(" ")[0] for line in lines[::3]]
    assert places == ["thing.yaml:2:15:", "thing.yaml:3:15:"]
    assert lines[2] == "    | " + " " * 14 + "^"


def test_a_missing_file_and_a_huge_one_are_refused(tmp_path: Path) -> None:
    with pytest.raises(DescriptionError, match="cannot be read: No such file"):
        read_text(tmp_path / "none.yaml", DescriptionError)
    (tmp_path / "big.yaml").write_bytes(b"#" * 1_000_001)
    with pytest.raises(DescriptionError, match="has 1000001 bytes; a description file has at most"):
        read_text(tmp_path / "big.yaml", DescriptionError)


@given(st.floats(-1e3, 1e3).map(lambda x: round(x, 6)))
def test_units_are_factors(value: float) -> None:
    length, position = TypeAdapter(Length), TypeAdapter(JointPosition)
    assert length.validate_python(f"{value:f} cm") == pytest.approx(value / 100)
    assert position.validate_python(f"{value:f} deg") == pytest.approx(math.radians(value))
    assert length.validate_python(value) == value


@pytest.mark.parametrize("wrong", ["5", "5 deg", "five m", True, None, "nan m", "5 m m"])
def test_what_is_no_length_is_refused(wrong: object) -> None:
    with pytest.raises(ValidationError):
        TypeAdapter(Length).validate_python(wrong)


def test_units_of_speeds_have_a_slash() -> None:
    assert TypeAdapter(JointSpeed).validate_python("36 deg/s") == pytest.approx(math.radians(36))

"""Quantities: every unit, several parts, and what is refused."""

import math
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.formats.units import Quantity, UnitError, in_one_of, in_unit, quantity, units_of

_IN_SI = {
    "ms": 1e-3,
    "s": 1.0,
    "min": 60.0,
    "h": 3600.0,
    "mm": 1e-3,
    "cm": 1e-2,
    "m": 1.0,
    "deg": math.pi / 180,
    "rad": 1.0,
    "Hz": 1.0,
    "N": 1.0,
    "kg": 1.0,
}


@given(st.floats(-1e6, 1e6), st.sampled_from(sorted(_IN_SI)), st.sampled_from(["", " "]))
def test_a_number_with_a_unit_is_that_many_si_units(number: float, unit: str, gap: str) -> None:
    found = quantity(f"{number!r}{gap}{unit}")
    assert found is not None
    assert found.value == pytest.approx(number * _IN_SI[unit], rel=1e-12)


def test_a_length_in_millimetres_is_the_nearest_number() -> None:
    assert [quantity(f"{n} mm") for n in (66, 70, 122, 150)] == [
        Quantity(value, "m") for value in (0.066, 0.07, 0.122, 0.15)
    ]


def test_parts_are_added() -> None:
    assert quantity("1 min 30 s") == Quantity(90.0, "s")
    assert quantity("1h 1min 1s 1ms") == Quantity(3661.001, "s")


@pytest.mark.parametrize("text", ["", "5", "table_a", "a 5 m", "5 m tall building!", "m"])
def test_what_is_no_quantity(text: str) -> None:
    assert quantity(text) is None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("5 sec", "did you mean 's'"),
        ("5 minutes", "did you mean 'min'"),
        ("5 MM", "did you mean 'mm'"),
        ("5 mn", "did you mean 'min'"),
        ("90°", "did you mean 'deg'"),
        ("5 furlongs", "Units: ms, s, min"),
        ("5 m 3 s", "adds a length and a time"),
    ],
)
def test_what_is_refused(text: str, message: str) -> None:
    with pytest.raises(UnitError, match=message.replace("+", r"\+")):
        quantity(text)


def test_another_kind_is_refused_with_the_valid_units() -> None:
    with pytest.raises(UnitError, match="expected an angle, in: deg, rad"):
        in_unit("5 m", "rad")
    assert units_of("m") == ("mm", "cm", "m")
    assert in_unit("180 deg", "rad") == math.pi


@pytest.mark.parametrize(("unit", "power"), [("mm", 3), ("cm", 2), ("ms", 3), ("g", 3)])
def test_decimals_are_converted_exactly(unit: str, power: int) -> None:
    """Every one of them is the number that the same digits in SI are."""
    for n in range(1, 2000):
        found = quantity(f"{n} {unit}")
        assert found is not None
        assert found.value == float(f"{n}e-{power}")
        tenth = quantity(f"{n / 10} {unit}")
        assert tenth is not None
        assert tenth.value == float(f"{n}e-{power + 1}")


@given(st.floats(-1e4, 1e4))
def test_degrees_are_converted_as_the_math_module_does(number: float) -> None:
    assert in_unit(f"{number!r} deg", "rad") == math.radians(number)


def test_the_tree_language_lists_every_unit() -> None:
    page = Path(__file__).parents[3] / "docs" / "tree_language.md"
    after = page.read_text(encoding="utf-8").partition("may have a unit:")[2]
    with pytest.raises(UnitError) as known:
        quantity("5 xyz")
    listed = after.partition(". Parts")[0]
    every = str(known.value).partition("Units: ")[2]
    assert sorted(re.findall(r"[^\s,]+", listed)) == sorted(every.split(", "))


def test_one_of_several_kinds() -> None:
    assert in_one_of("5 cm", ("rad", "m")) == Quantity(0.05, "m")
    assert in_one_of("5", ("rad", "m")) is None
    with pytest.raises(UnitError, match="'5 kg' is a mass; expected an angle or a length, in: deg"):
        in_one_of("5 kg", ("rad", "m"))
    with pytest.raises(UnitError, match="unknown unit 'xyz'. Units: deg, rad, mm, cm, m$"):
        in_one_of("5 xyz", ("rad", "m"))

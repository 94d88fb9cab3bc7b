"""Laws of quantities: units of a kind agree, parts add up, spaces mean nothing; and every type."""

import math
from contextlib import suppress
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.formats.places import Place
from momantu_bt.formats.units import UnitError, in_unit, quantity, units_of
from momantu_bt.messages import VALUE_TYPES
from momantu_bt.skill import Port
from momantu_bt.tree.model import PortDeclaration
from momantu_bt.values.convert import convert, natural
from momantu_bt.values.types import assignable, label, parse_type
from momantu_bt.values.words import ConversionError

KINDS = ["s", "m", "rad", "Hz", "N", "kg", "m/s", "rad/s", "m/s2", "rad/s2"]
NUMBERS = st.floats(-1e6, 1e6).map(lambda x: round(x, 6))


@given(NUMBERS, st.sampled_from(KINDS), st.data())
def test_two_units_of_a_kind_agree(number: float, kind: str, data: st.DataObject) -> None:
    one = data.draw(st.sampled_from(units_of(kind)))
    in_si = in_unit(f"{number} {one}", kind)
    scale = in_unit(f"1 {one}", kind)
    assert in_si is not None
    assert scale is not None
    assert scale > 0
    assert in_si == pytest.approx(number * scale, rel=1e-12)
    assert in_unit(f"{in_si!r} {kind}", kind) == in_si


@given(
    st.lists(st.tuples(NUMBERS, st.sampled_from(["ms", "s", "min", "h"])), min_size=1, max_size=4)
)
def test_parts_add_up_whatever_the_spaces(parts: list[tuple[float, str]]) -> None:
    spaced = quantity(" ".join(f"{number} {unit}" for number, unit in parts))
    tight = quantity("  " + " ".join(f"{number}{unit}" for number, unit in parts) + " ")
    one_by_one = [in_unit(f"{number} {unit}", "s") for number, unit in parts]
    assert spaced == tight
    assert spaced is not None
    assert spaced.value == pytest.approx(sum(x for x in one_by_one if x is not None), 1e-12, 1e-9)


@given(st.text(alphabet="0123456789.eE+- mskgradNHz2/°µ%", max_size=20))
def test_any_text_is_a_finite_quantity_or_none_or_refused(text: str) -> None:
    with suppress(UnitError):
        found = quantity(text)
        assert found is None or (math.isfinite(found.value) and found.unit in KINDS)


@pytest.mark.parametrize("kind", KINDS)
def test_a_unit_fits_its_own_kind_alone(kind: str) -> None:
    for unit in units_of(kind):
        assert in_unit(f"2 {unit}", kind) is not None
        for other in KINDS:
            if other != kind:
                with pytest.raises(UnitError, match="expected"):
                    in_unit(f"2 {unit}", other)


def test_full_turns_and_hours_are_exact() -> None:
    assert in_unit("360 deg", "rad") == 2 * math.pi
    assert in_unit("1 h", "s") == in_unit("60 min", "s") == in_unit("3600000 ms", "s") == 3600.0
    assert in_unit("0.1 m", "m") == in_unit("10 cm", "m") == in_unit("100 mm", "m") == 0.1


TOO_LARGE = ["1e999 m", "1e308 h", "1e308 h 1e308 h"]


@pytest.mark.parametrize("text", TOO_LARGE)
def test_what_no_number_can_hold_is_refused(text: str) -> None:
    with pytest.raises(UnitError, match="too large"):
        quantity(text)
    assert natural(text) == text


SAMPLES: list[Any] = [
    *(None, True, False, 0, -3, 2.0, 2.5, "", "text", "3", "3 cm", "90 deg", "yes", [], [1, 2]),
    *(["1 cm", "2 m"], [[1]], {}, {"x": 1, "y": 2}, {"x": "1 m", "y": 2, "yaw": "90 deg"}),
    *({"category": "can", "diameter": "66 mm"}, {"category": 3}, {"X": 1}, float("inf")),
]


@pytest.mark.parametrize("name", [*VALUE_TYPES, *(f"list of {name}" for name in VALUE_TYPES)])
@pytest.mark.parametrize("unit", [None, "m"])
def test_every_value_fits_every_type_or_is_refused(name: str, unit: str | None) -> None:
    type_ = parse_type(name)
    port = Port("p", "in", type_, "", unit=unit)
    fitting = 0
    for sample in SAMPLES:
        with suppress(ConversionError):
            found = convert(sample, port)
            fitting += 1
            assert convert(found, port) == found
            assert assignable(type(found), type_) or isinstance(found, tuple)
    assert fitting > 0 or name in NOT_WRITTEN_OUT


NOT_WRITTEN_OUT = {
    name
    for name, type_ in VALUE_TYPES.items()
    if name not in ("any", "text", "number", "int", "bool", "pose2d", "object_class")
}
"""Types that only skills make."""


@given(st.sampled_from(sorted(VALUE_TYPES)), st.sampled_from(sorted(VALUE_TYPES)))
def test_lists_flow_as_their_items_do(left: str, right: str) -> None:
    items = assignable(parse_type(left), parse_type(right))
    lists = assignable(parse_type(f"list of {left}"), parse_type(f"list of {right}"))
    assert items is lists
    optional = parse_type(right) | None
    assert assignable(parse_type(left), optional) is items or items is False


@pytest.mark.parametrize("name", ["txt", "list", "list of", "list of  txt", "int | text", ""])
def test_names_of_no_type(name: str) -> None:
    with pytest.raises(KeyError):
        PortDeclaration("p", "in", name, Place("t", 1, 1)).port()


def test_an_enumeration_flows_into_itself() -> None:
    from enum import Enum

    class Side(Enum):
        LEFT = "left"
        RIGHT = "right"

    class Other(Enum):
        LEFT = "left"

    assert assignable(Side, Side)
    assert assignable(Side, Side | None)
    assert assignable(tuple[Side, ...], tuple[Side, ...])
    assert not assignable(Side, Other)
    assert label(Side) == "'left' or 'right'"

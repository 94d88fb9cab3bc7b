"""What the text of an XML attribute means, with and without our prefix."""

from typing import Any, Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.formats.places import Place
from momantu_bt.geometry import Pose2D
from momantu_bt.tree.files.xml.values import WireError, attribute_value, flow_value, takes_text
from momantu_bt.tree.model import Literal as Written
from momantu_bt.tree.model import Reference, Scope, Template
from momantu_bt.tree.problems import Problems

PLACE = Place("t.xml", 3, 10, 0)


def flow(text: str) -> tuple[Any, list[Any]]:
    problems = Problems()
    place = Place("t.xml", 3, 10, max(1, len(text)))
    return flow_value(text, "port", place, problems), problems.sorted()


@pytest.mark.parametrize(
    ("text", "type_", "expected"),
    [
        ("{goal}", object, Reference("goal")),
        (" {goal} ", str, Reference("goal")),
        ("{@goal}", str, Reference("goal", scope=Scope.ROOT)),
        ("{=}", str, Reference("port")),
        ("5", object, Written(5)),
        ("5", float, Written(5)),
        ("5", str, Written("5")),
        ("5", str | None, Written("5")),
        ("5", str | Pose2D, Written(5)),
        ("5", Literal["a", "5"], Written("5")),
        ("0.5", object, Written(0.5)),
        ("true", bool, Written(True)),
        ("1", bool, Written(True)),
        ("False", bool, Written(False)),
        ("True", object, Written("True")),
        ("010", int, Written("010")),
        ("2.50", float, Written("2.50")),
        ("0x10", int, Written("0x10")),
        ("1e3", float, Written("1e3")),
        ("-0", int, Written("-0")),
        ("1;2;3", object, Written("1;2;3")),
        ("null", object, Written("null")),
        ("", object, Written("")),
        ("at {n}", str, Written("at {n}")),
        ("$5", str, Written("$5")),
        ("{a b", str, Written("{a b")),
    ],
)
def test_plain_attributes(text: str, type_: Any, expected: Any) -> None:
    found = attribute_value(text, "port", type_)
    assert found == expected
    if isinstance(found, Written):
        assert type(found.value) is type(expected.value)


@pytest.mark.parametrize("text", ["{a b}", "{a.b}", "{1a}", "{@}", "{{a}}", "{a};{b}"])
def test_braces_around_no_key(text: str) -> None:
    with pytest.raises(WireError, match="names no key"):
        attribute_value(text, "port", str)


@pytest.mark.parametrize("text", ["{key", "key}", "$key", "{@key", "$@key"])
def test_half_a_wire(text: str) -> None:
    with pytest.raises(WireError, match=r"did you mean \{@?key\}\?"):
        attribute_value(text, "port", str)


@given(st.one_of(st.booleans(), st.integers(), st.floats(allow_nan=False, allow_infinity=False)))
def test_a_number_as_python_writes_it_is_that_number(value: Any) -> None:
    text = ("true" if value else "false") if isinstance(value, bool) else repr(value)
    found = attribute_value(text, "port", object)
    assert isinstance(found, Written)
    assert (found.value, type(found.value)) == (value, type(value)) or len(text) > 40


@given(st.text(max_size=12))
def test_a_port_of_text_takes_every_text_that_is_no_wire(text: str) -> None:
    if text.strip(" ").startswith(("{", "$")) or text.endswith("}"):
        return
    assert attribute_value(text, "port", str) == Written(text)


def test_choices_of_text_are_text() -> None:
    assert takes_text(Literal["a", "b"])
    assert takes_text(str | None)
    assert not takes_text(str | float)
    assert not takes_text(object)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("$found.pose", Reference("found", ("pose",))),
        ("$=", Reference("port")),
        ("at ${n}", Template(("at ", Reference("n")))),
        ("{category: can, diameter: 66 mm}", Written({"category": "can", "diameter": "66 mm"})),
        ("[1, two]", Written([1, "two"])),
        ('"5"', Written("5")),
        ("1.5 s", Written("1.5 s")),
        ("010", Written(10)),
    ],
)
def test_attributes_of_ours(text: str, expected: Any) -> None:
    assert flow(text) == (expected, [])


@pytest.mark.parametrize(
    ("text", "code", "column"),
    [
        ("{key}", "braces", 10),
        ("at $ 5", "dollar", 10),
        ("[a, $b]", "wire-inside", 14),
        ("{a: 1, a: 2}", "duplicate-key", 17),
        ("[1, 2", "syntax", 10),
        ("", "syntax", 10),
    ],
)
def test_problems_of_ours_stand_where_they_are(text: str, code: str, column: int) -> None:
    _, problems = flow(text)
    assert [(p.code, p.place.line, p.place.column) for p in problems] == [(code, 3, column)]


def test_a_text_with_entities_is_marked_as_a_whole() -> None:
    problems = Problems()
    place = Place("t.xml", 3, 10, 12)
    flow_value("[&, $b]", "port", place, problems)
    assert [p.place for p in problems.sorted()] == [place]

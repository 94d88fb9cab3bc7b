"""Every kind of mistake in a file is told at its line and column, with what would be right."""

from __future__ import annotations

import re
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, ConfigDict, Field

from momantu_bt.descriptions.reading import (
    MOST_BYTES,
    MOST_ERRORS,
    DescriptionError,
    Reading,
    read_text,
)
from momantu_bt.descriptions.validation import checked
from momantu_bt.formats.places import Place

FILE = Path("thing.yaml")


class Strict(BaseModel):
    model_config = ConfigDict(extra="forbid")


class Colour(StrEnum):
    RED = "red"
    GREEN = "green"


class Ball(Strict):
    kind: Literal["ball"]
    radius: float


class Brick(Strict):
    kind: Literal["brick"]
    size: tuple[float, float, float]


class Toy(Strict):
    name: Annotated[str, Field(pattern="^[a-z]+$")] = "toy"
    note: Annotated[str, Field(min_length=1, max_length=5)] = "x"
    count: int = 1
    loud: bool = False
    weight: Annotated[float, Field(allow_inf_nan=False)] = 1.0
    colour: Colour = Colour.RED
    mood: Literal["good", "bad"] = "good"
    at: tuple[float, float] = (0.0, 0.0)
    tags: Annotated[list[str], Field(min_length=1, max_length=2)] = ["a"]
    shape: Annotated[Ball | Brick, Field(discriminator="kind")] | None = None
    shapes: list[Annotated[Ball | Brick, Field(discriminator="kind")]] = []


def toy(text: str) -> Toy:
    return checked(Reading(FILE, text, DescriptionError), Toy, DescriptionError)


MISTAKES = [
    ("count: many", "1:8", "count: expected a whole number; found 'many'"),
    ("count: 1.5", "1:8", "count: expected a whole number; found 1.5"),
    ("count:", "1:1", "count: expected a whole number; found nothing"),
    ("loud: 7", "1:7", "loud: expected true or false; found 7"),
    ("weight: heavy", "1:9", "weight: expected a number; found 'heavy'"),
    ("weight: .inf", "1:9", "weight: expected a number; found '.inf'"),
    ("name: 3", "1:7", "name: expected a text; found 3"),
    ("name: Big Bear", "1:7", "name: expected a name: lower-case letters"),
    ("note: ''", "1:7", "note: expected a text; found ''"),
    ("note: endless", "1:7", "note: expected at most 5 characters"),
    ("colour: gren", "1:9", "'gren' is not possible here; did you mean 'green'? Possible: 'red'"),
    ("mood: awful", "1:7", "'awful' is not possible here; possible: 'good', 'bad'"),
    ("at: 4", "1:5", "at: expected a list; found 4"),
    ("at: [1]", "1:5", "at: expected 2 values, found 1"),
    ("at: [1, 2, 3]", "1:5", "at: expected at most 2 values, found 3"),
    ("at: [1, x]", "1:9", "at.1: expected a number; found 'x'"),
    ("tags: []", "1:7", "tags: expected at least 1 value, found 0"),
    ("tags: [a, b, c]", "1:7", "tags: expected at most 2 values, found 3"),
    ("tags: a", "1:7", "tags: expected a list; found 'a'"),
    ("shape: 5", "1:8", "shape"),
    ("shape: {radius: 1}", "1:8", "shape needs a key 'kind'; possible: ball, brick"),
    ("shape: {kind: bal}", "1:15", "'bal' is not possible here; possible: ball, brick"),
    ("shape: {kind: ball, radus: 1}", "1:21", "unknown key 'radus' in shape; did you mean"),
    ("shapes: [{kind: ball}]", "1:10", "shapes.0 needs a key 'radius'"),
    ("shapes: [{kind: ball, size: 1, radius: 2}]", "1:23", "unknown key 'size' in shapes.0; keys"),
    ("- a", "1:1", "the description: expected a mapping with the keys name, note, count"),
    ("colr: red", "1:1", "unknown key 'colr' in the description; did you mean 'colour'? Keys"),
    (f"mood: {'m' * 99}", "1:7", f"'{'m' * 59}… is not possible here"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "place", "words"), MISTAKES)
def test_a_mistake_says_what_would_be_right(text: str, place: str, words: str) -> None:
    with pytest.raises(DescriptionError) as told:
        toy(text)
    assert str(told.value).startswith(f"thing.yaml:{place}: ")
    assert words in str(told.value)


@given(
    st.lists(
        st.sampled_from([m for m in MISTAKES[:20] if "inf" not in m[0]]),
        unique_by=lambda m: m[0].split(":")[0],
    )
)
def test_mistakes_are_told_together_each_at_its_line(some: list[tuple[str, str, str]]) -> None:
    """One does not hide the other, and the lines are those of the file."""
    text = "\n".join(line for line, _, _ in some)
    if not some:
        return
    with pytest.raises(DescriptionError) as told:
        toy(text)
    assert [p.place.line for p in told.value.problems] == list(range(1, len(some) + 1))
    for problem, (line, place, words) in zip(told.value.problems, some, strict=True):
        assert words in problem.message
        assert problem.place.column == int(place.split(":")[1])
        assert line in str(told.value)


def test_the_caret_stands_under_the_mistake() -> None:
    with pytest.raises(DescriptionError) as told:
        toy("shape:\n  kind: ball\n  radius: wide\n")
    said, line, caret = str(told.value).splitlines()
    assert said.startswith("thing.yaml:3:11: shape.radius: expected a number")
    assert line[caret.index("^") :] == "wide"


def test_a_file_full_of_mistakes_is_told_as_far_as_it_helps() -> None:
    with pytest.raises(DescriptionError) as told:
        toy("\n".join(f"wrong{i}: 1" for i in range(MOST_ERRORS + 7)))
    assert len(told.value.problems) == MOST_ERRORS + 7
    assert str(told.value).endswith("... and 7 more")
    assert len(re.findall("unknown key", str(told.value))) == MOST_ERRORS


def test_files_that_cannot_be_read_are_told(tmp_path: Path) -> None:
    with pytest.raises(DescriptionError, match="cannot be read: No such file"):
        read_text(tmp_path / "none.yaml", DescriptionError)
    large = tmp_path / "large.yaml"
    large.write_bytes(b"#" * (MOST_BYTES + 1))
    with pytest.raises(DescriptionError, match=f"has {MOST_BYTES + 1} bytes; a description file"):
        read_text(large, DescriptionError)
    large.write_bytes(b"#" * MOST_BYTES)
    assert len(read_text(large, DescriptionError)) == MOST_BYTES
    large.write_bytes(b"a: 1\nb: \xff\n")
    with pytest.raises(DescriptionError, match=r"large\.yaml:2:4: the file is not UTF-8 text"):
        read_text(large, DescriptionError)


def test_what_is_wrong_elsewhere_is_told_at_the_nearest_place() -> None:
    reading = Reading(FILE, "shape:\n  kind: ball\n", DescriptionError)
    assert reading.value(("shape", "kind")) == "ball"
    assert reading.at(("shape", "kind", "no", "such")) == Place("thing.yaml", 2, 9, 4)
    assert reading.at(("shape", "kind"), key=True) == Place("thing.yaml", 2, 3, 4)
    assert reading.at(("nothing",)) == Place("thing.yaml", 1, 1)
    reading.refuse([])
    with pytest.raises(DescriptionError) as told:
        reading.refuse([(("shape", "kind"), "too round"), (("shape",), "too small")])
    assert [(p.place, p.message, p.keys) for p in told.value.problems] == [
        (Place("thing.yaml", 2, 3), "too small", ("shape",)),
        (Place("thing.yaml", 2, 9, 4), "too round", ("shape", "kind")),
    ]

"""What is written below a field is its description in the schema, and nothing else is."""

from __future__ import annotations

from typing import Any

import pytest
from pydantic import BaseModel

from momantu_bt.descriptions.field_docs import field_docs
from momantu_bt.robot_parts import Part
from momantu_bt.robots.robot_file import RobotFile


class Wheel(Part):
    """A wheel."""

    radius: float
    """From the axis
    to the floor, m."""
    spokes: int = 8
    rubber: bool = False

    """Below an empty line."""

    def turn(self) -> None:
        """No field."""


class DrivenWheel(Wheel):
    """A wheel with a motor."""

    torque: float
    """Nm."""
    rubber: bool = True
    """Of the tyre."""

    class Motor(Part):
        """Inside."""

        poles: int
        """Pairs of them."""


def test_docstrings_of_fields_with_those_of_base_classes() -> None:
    wheel = {"radius": "From the axis\nto the floor, m.", "rubber": "Below an empty line."}
    assert field_docs(Wheel) == wheel
    assert field_docs(DrivenWheel) == {**wheel, "torque": "Nm.", "rubber": "Of the tyre."}
    assert field_docs(DrivenWheel.Motor) == {"poles": "Pairs of them."}


def test_the_schema_has_them() -> None:
    fields: dict[str, Any] = DrivenWheel.model_json_schema()["properties"]
    told = {name: field.get("description") for name, field in fields.items()}
    assert told == {
        "radius": "From the axis\nto the floor, m.",
        "spokes": None,
        "rubber": "Of the tyre.",
        "torque": "Nm.",
    }


def test_every_key_of_a_robot_file_is_described_as_pydantic_itself_would() -> None:
    class Plain(BaseModel, use_attribute_docstrings=True):
        part: str
        """What it is."""

    assert Plain.model_fields["part"].description == field_docs(Plain)["part"]
    fields = RobotFile.model_json_schema(mode="validation")["properties"]
    assert [name for name, field in fields.items() if not field.get("description")] == []


def test_without_source_there_are_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Wheel, "__module__", "no_such_module")
    assert field_docs(Wheel) == {}

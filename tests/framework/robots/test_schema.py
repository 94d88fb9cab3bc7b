"""What editors are told of robot files agrees with what reads them."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator
from ruamel.yaml import YAML

from momantu_bt.cli import main
from momantu_bt.cli.robots.schema import robot_schema
from momantu_bt.robots import read_robot

Write = Callable[..., Path]
SCHEMA = robot_schema()
PAGE = Path(__file__).resolve().parents[3] / "docs" / "robots.md"


def objections(text: str) -> list[str]:
    data = YAML(typ="safe", pure=True).load(text)
    return [error.message for error in Draft202012Validator(SCHEMA).iter_errors(data)]


def keys(schema: Any) -> Iterator[tuple[str, str | None]]:
    """Every key of a robot file with what is said of it."""
    for model in (schema, *schema["$defs"].values()):
        for name, told in model.get("properties", {}).items():
            yield name, told.get("description")


def test_a_robot_file_is_what_the_schema_wants(carter: Write) -> None:
    assert objections(carter().read_text()) == []


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("height: 0.9", "hight: 0.9"),
        ("max_width: 8 cm", "max_width: 8 kg"),
        ("{on: base_link, xyz: [10 cm, 0, 30 cm]", "{on: base_link, xyz: [10 cm, 0]"),
        ("kind: base}", "kind: wheels}"),
        ("  frame: hand\n", ""),
    ],
)
def test_what_reading_refuses_the_schema_refuses(carter: Write, old: str, new: str) -> None:
    assert objections(carter(robot=(old, new)).read_text())


def test_every_key_says_what_it_means() -> None:
    assert [name for name, told in keys(SCHEMA) if told is None and name != "kind"] == []


def test_every_key_stands_on_the_page_about_robots() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert [name for name, _ in keys(SCHEMA) if f"`{name}`" not in page] == []


def test_the_verb_writes_it_and_refuses_a_folder(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "robot.schema.json"
    assert main(["robots", "schema", "-o", str(out)]) == 0
    assert f"# yaml-language-server: $schema={out}" in capsys.readouterr().out
    written = json.loads(out.read_text())
    assert written["properties"].keys() == SCHEMA["properties"].keys()
    assert main(["robots", "schema", "-o", str(tmp_path)]) == 2
    assert main(["robots", "schema"]) == 0
    captured = capsys.readouterr()
    assert json.loads(captured.out) == written


def test_the_pages_example_is_a_robot(carter: Write) -> None:
    example = PAGE.read_text(encoding="utf-8").partition("```yaml\n")[2].partition("```")[0]
    file = carter()
    robot = read_robot(file)
    file.write_text(example)
    assert read_robot(file) == robot

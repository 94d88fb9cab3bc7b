"""The JSON Schema of world files: it accepts what the reader accepts, and helps an editor."""

import copy
import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from momantu_worlds.scenes.file.reader import WorldFileError, parse_world
from momantu_worlds.scenes.loading import world_path
from momantu_worlds.verbs.schema_descriptions import DESCRIPTIONS, description_of
from momantu_worlds.verbs.template import two_rooms
from momantu_worlds.verbs.worlds_schema import world_schema
from ruamel.yaml import YAML

from momantu_bt.cli import main
from momantu_bt.descriptions.quantities import UNITS_KEY

SCHEMA = world_schema()
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)
BUNDLED = sorted(world_path("four_rooms").parent.glob("*.yaml"))
TEXT = two_rooms(Path("flat.yaml"), "8x5", None)


def plain(text: str) -> dict[str, Any]:
    data: dict[str, Any] = YAML(typ="safe", pure=True).load(text)
    return data


@pytest.mark.parametrize("file", BUNDLED, ids=lambda file: file.stem)
def test_every_bundled_world_is_accepted(file: Path) -> None:
    assert list(VALIDATOR.iter_errors(plain(file.read_text(encoding="utf-8")))) == []


def test_a_new_world_is_accepted() -> None:
    assert list(VALIDATOR.iter_errors(plain(TEXT))) == []


MISTAKES: list[tuple[tuple[str, ...], Any]] = [
    (("tables", "table_a", "kind"), "tabel"),
    (("tables", "table_a", "shift"), "5 kg"),
    (("tables", "table_a", "size"), [0.8, 1.4]),
    (("tables", "table_a", "sides"), []),
    (("start", "at"), ["here", 0, 0]),
    (("start", "belief_shft"), 0.1),
    (("doors", "door", "width"), -1),
    (("doors", "door", "width"), True),
    (("goal", "force"), "150 kg"),
    (("tag", "id"), 100000),
    (("momantu_world",), 2),
    (("nmae",), "flat"),
]


@pytest.mark.parametrize(("place", "value"), MISTAKES, ids=str)
def test_what_it_refuses_the_reader_refuses_too(place: tuple[str, ...], value: Any) -> None:
    data = copy.deepcopy(plain(TEXT))
    inner = data
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    assert not VALIDATOR.is_valid(data)
    with pytest.raises(WorldFileError):
        parse_world(json.dumps(data), Path("flat.yaml"))


def test_it_is_a_schema_and_tells_units_where_there_are_any() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    assert UNITS_KEY not in json.dumps(SCHEMA)
    width = SCHEMA["$defs"]["Door"]["properties"]["width"]
    assert width["description"] == "Of the gap. [m, or written with a unit: m, cm, mm]"
    assert width["anyOf"][0] == {"type": "number", "exclusiveMinimum": 0}
    assert "title" not in SCHEMA["$defs"]["Door"]


def test_every_key_is_described_and_no_words_are_left_over() -> None:
    parts = {"WorldFile": SCHEMA, **SCHEMA["$defs"]}
    keys = {(part, key) for part, schema in parts.items() for key in schema.get("properties", {})}
    assert {f"{part}.{key}" for part, key in keys if description_of(part, key) is None} == set()
    of_all = {f"*.{key}" for _, key in keys}
    assert set(DESCRIPTIONS) - {f"{part}.{key}" for part, key in keys} - of_all == set()
    for part, key in keys:
        assert str(description_of(part, key)) in parts[part]["properties"][key]["description"]


def test_the_verb_prints_or_writes_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["worlds", "schema"]) == 0
    assert json.loads(capsys.readouterr().out) == SCHEMA
    file = tmp_path / "world.schema.json"
    assert main(["worlds", "schema", "-o", str(file)]) == 0
    assert json.loads(file.read_text(encoding="utf-8")) == SCHEMA
    assert f"$schema={file}" in capsys.readouterr().out
    assert main(["worlds", "schema", "-o", str(tmp_path / "none" / "a.json")]) == 2

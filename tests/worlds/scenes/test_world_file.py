"""A wrong world file is answered with every mistake, its place, and what would be right."""

from pathlib import Path

import pytest
from momantu_worlds.scenes.loading import FOLDER, load_world
from momantu_worlds.scenes.world_reader import WorldFileError, parse_world, read_world

from momantu_bt.world import WorldError

TEXT = (FOLDER / "four_rooms.yaml").read_text(encoding="utf-8")
PATH = Path("rooms.yaml")


def changed(before: str, after: str) -> str:
    assert TEXT.count(before) == 1, before
    return TEXT.replace(before, after)


def refusal(text: str) -> WorldFileError:
    with pytest.raises(WorldFileError) as caught:
        parse_world(text, PATH)
    return caught.value


def line_of(text: str, part: str) -> int:
    return text[: text.index(part)].count("\n") + 1


def test_the_bundled_world_is_read_with_units_in_si():
    world = load_world("four_rooms")
    assert world.item.radius == pytest.approx(0.035)
    assert world.tables["table_a"].turn == pytest.approx(0.0872665, abs=1e-6)
    assert len(world.walls.pieces) == 15


CASES = [
    ("  shift: 20 cm", "  shfit: 20 cm", "shfit", ["unknown key 'shfit'", "did you mean 'shift'?"]),
    ("  thickness: 15 cm", "  thickness: 15 kg", "15 kg", ["'kg' is not a unit", "m, cm, mm"]),
    ("  thickness: 15 cm", "  thickness: thick", "thick\n", ["'thick' is not a length"]),
    ("  thickness: 15 cm", "  thickness: -1", "-1\n", ["greater than 0"]),
    ("  thickness: 15 cm", "  thickness: .inf", ".inf", ["not a number that can be read"]),
    ("  friction: 0.9", "  friction: 100", "100", ["less than or equal to 1"]),
    ("  mass: 0.4 kg\n", "", "name: can", ["item needs a key 'mass'"]),
    ("    kind: desk\n", "    kind: throne\n", "throne", ["'throne' is not possible", "'desk'"]),
    ("  id: 1 ", "  id: 400 ", "id: 400", ["tag.id", "less than 30"]),
    ("moved: {least: 2, most: 5}", "moved: {least: 6, most: 5}", "{least: 6", ["more than most"]),
    (
        "  beside: tag",
        "  beside: flag",
        "flag\n",
        ["there is no tag or body 'flag'", "tag, table_a"],
    ),
    ("  item: can\n", "  item: mug\n", "mug\n", ["there is no object 'mug'", "objects: can"]),
    ("  edge: 150 mm ", "  edge: 010x ", "010x", ["'x' is not a unit of a length"]),
    ("  chair_a: {", "  table_a: {", "{kind: chair, at: [-1.20", ["'table_a' is a table already"]),
]


@pytest.mark.parametrize(("before", "after", "place", "words"), CASES, ids=lambda c: str(c)[:25])
def test_a_mistake_is_named_at_its_line(before, after, place, words):
    text = changed(before, after)
    error = refusal(text)
    assert len(error.problems) == 1, error
    assert error.problems[0].line == line_of(text, place)
    for word in words:
        assert word in str(error)
    assert f"rooms.yaml:{error.problems[0].line}:{error.problems[0].column}: " in str(error)


def test_every_mistake_is_listed_at_once():
    text = changed("  thickness: 15 cm", "  thickness: 15 kg").replace("  id: 1 ", "  ident: 1 ")
    messages = [problem.message for problem in refusal(text).problems]
    assert len(messages) == 3
    assert "walls.thickness" in messages[0]
    assert any("unknown key 'ident' in tag" in m for m in messages)
    assert any("tag needs a key 'id'" in m for m in messages)


def test_a_caret_stands_under_the_place():
    lines = str(refusal(changed("  shift: 20 cm", "  shfit: 20 cm"))).splitlines()
    at = next(i for i, line in enumerate(lines) if line.endswith("shfit: 20 cm"))
    assert lines[at + 1].index("^") == lines[at].index("shfit")


def test_a_key_written_twice_is_refused_with_both_places():
    text = changed("  shift: 20 cm", "  shift: 20 cm\n  shift: 30 cm")
    error = refusal(text)
    assert f"'shift' is here twice; first in line {line_of(text, '  shift: 20 cm')}" in str(error)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "the file is empty"),
        ("walls: [1, 2", "this is not YAML"),
        ("a: *nothing", "this is not YAML"),
        ("- 1\n- 2\n", "the world"),
        ("name: " + "[" * 40 + "]" * 40, "levels deep"),
    ],
)
def test_what_is_no_world_is_refused_in_words(text, words):
    assert words in str(refusal(text))


def test_a_missing_file_and_a_folder_are_world_errors(tmp_path):
    for path in (tmp_path / "none.yaml", tmp_path):
        with pytest.raises(WorldError, match="cannot be read"):
            read_world(path)


def test_a_huge_file_is_not_parsed(tmp_path):
    path = tmp_path / "big.yaml"
    path.write_bytes(b"#" * 2_000_000)
    with pytest.raises(WorldError, match="2000000 bytes"):
        read_world(path)


def test_a_world_that_does_not_exist_is_a_world_error():
    with pytest.raises(WorldError, match="no_such_world"):
        load_world("no_such_world")

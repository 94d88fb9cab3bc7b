"""A wrong world file is answered with every mistake, its place, and what would be right."""

from importlib.metadata import EntryPoint
from pathlib import Path

import pytest
from momantu_worlds.scenes.file.reader import WorldFileError, parse_world, read_world
from momantu_worlds.scenes.loading import FOLDER, load_world

from momantu_bt import plugins
from momantu_bt.descriptions.tunables import TUNABLES

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
    ("  thickness: 15 cm", "  thickness: 15 kg", "15 kg", ["expected a length", "mm, cm, m"]),
    ("  thickness: 15 cm", "  thickness: thick", "thick\n", ["'thick' is not a length"]),
    ("  thickness: 15 cm", "  thickness: -1", "-1\n", ["greater than 0"]),
    ("  thickness: 15 cm", "  thickness: .inf", ".inf", ["is not a length; write a number"]),
    ("  friction: 0.9", "  friction: 100", "100", ["less than or equal to 1"]),
    ("  kind: can\n", "", "name: can", ["item needs a key 'kind'"]),
    ("    kind: desk\n", "    kind: throne\n", "throne", ["'throne' is not possible", "'desk'"]),
    ("  id: 1 ", "  id: 600 ", "id: 600", ["tag.id", "less than 587"]),
    ("moved: {least: 2, most: 5}", "moved: {least: 6, most: 5}", "{least: 6", ["more than most"]),
    (
        "  beside: tag",
        "  beside: flag",
        "flag\n",
        ["there is no tag or body 'flag'", "tag, table_a"],
    ),
    ("  item: can\n", "  item: mug\n", "mug\n", ["there is no object 'mug'", "objects: can"]),
    ("  edge: 150 mm ", "  edge: 010x ", "010x", ["unknown unit 'x'. Units: mm, cm, m"]),
    (
        "  resolution: 5 cm",
        "  zones: {lab: {kind: slow, corners: [[0, 0], [1, 0], [1, 1]]}}",
        "  zones: {lab",
        ["site.zones.lab: a slow zone needs its `speed`"],
    ),
    (
        "  resolution: 5 cm",
        "  zones: {lab: {kind: keep_out, corners: [[0, 0], [1, 1], [1, 0], [0, 1]]}}",
        "  zones: {lab",
        ["site.zones.lab.corners: its sides cross", "one after the other around the zone"],
    ),
    (
        "  resolution: 5 cm",
        "  zones: {lab: {kind: forbidden, corners: [[0, 0], [1, 1], [1, 0]]}}",
        "  zones: {lab",
        ["'forbidden' is not possible", "'keep_out'"],
    ),
    ("  chair_a: {", "  table_a: {", "{kind: chair, at: [-1.20", ["'table_a' is a table already"]),
]


@pytest.mark.parametrize(("before", "after", "place", "words"), CASES, ids=lambda c: str(c)[:25])
def test_a_mistake_is_named_at_its_line(before, after, place, words):
    text = changed(before, after)
    error = refusal(text)
    assert len(error.problems) == 1, error
    assert error.problems[0].place.line == line_of(text, place)
    for word in words:
        assert word in str(error)
    assert f"{error.problems[0].place}: " in str(error)


def test_every_mistake_is_listed_at_once():
    text = changed("  thickness: 15 cm", "  thickness: 15 kg").replace("  id: 1 ", "  ident: 1 ")
    messages = [problem.message for problem in refusal(text).problems]
    assert len(messages) == 2
    assert "walls.thickness" in messages[0]
    assert any("unknown key 'ident' in tag" in m for m in messages)


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
        ("walls: [1, 2", "a `[` that is never closed"),
        ("a: *nothing", "`*nothing` stands for nothing"),
        ("- 1\n- 2\n", "the world"),
        ("name: " + "[" * 40 + "]" * 40, "levels deep"),
    ],
)
def test_what_is_no_world_is_refused_in_words(text, words):
    assert words in str(refusal(text))


def test_a_missing_file_and_a_folder_are_refused(tmp_path):
    for path in (tmp_path / "none.yaml", tmp_path):
        with pytest.raises(WorldFileError, match="cannot be read"):
            read_world(path)


def test_a_huge_file_is_not_parsed(tmp_path):
    path = tmp_path / "big.yaml"
    path.write_bytes(b"#" * 2_000_000)
    with pytest.raises(WorldFileError, match="2000000 bytes"):
        read_world(path)


def test_a_world_that_does_not_exist_is_refused():
    with pytest.raises(WorldFileError, match="no_such_world"):
        load_world("no_such_world")


STUDIO = """momantu_world: 1
name: studio
rooms: {hall: {corner: [0, 0], size: [6, 4]}}
doors: {out: {at: [3, 0]}}
furniture:
  rack: {kind: shelf, at: [1, 1, 0], size: [0.4, 1, 1.2], boards: [0.1, 0.6]}
tables:
  desk: {at: [5, 2, 0], size: [0.8, 1.2, 0.7], sides: [0]}
  low: {board_of: rack, board: 2, sides: [0 deg]}
objects: {cup: {kind: mug, on: desk}}
tags: {mark: {id: 1, edge: 10 cm, on: low, at: [0, 0]}}
bodies: {post: {parts: [{sphere: 10 cm}]}}
start: {at: [3, 2, 0]}
goal: {item: cup, on: low, beside: mark}
"""


def test_the_world_of_the_cases_below_is_fine():
    assert parse_world(STUDIO, PATH).sought == "cup"


SECTIONS = [
    ("name: studio", "name: My Studio", "expected a name: lower-case letters"),
    ("name: studio", "name: none", "'none' means no world at all"),
    ("{at: [3, 0]}", "{at: [3, 1]}", "the door 'out': no wall of a room is there"),
    ("{at: [3, 0]}", "{at: 3}", "doors.out.at: expected a list; found 3"),
    ("size: [6, 4]", "size: [6]", "rooms.hall.size: expected 2 values, found 1"),
    ("size: [6, 4]", "size: [6, 4, 1]", "rooms.hall.size: expected at most 2 values, found 3"),
    (", size: [6, 4]", "", "write corner and size, or an outline"),
    ("{corner: [0, 0], size: [6, 4]}", "big", "expected a mapping with the keys corner, size"),
    ("boards: [0.1, 0.6]", "boards: [0.6, 0.1]", "heights from below upwards"),
    ("boards: [0.1, 0.6]", "boards: [0.1, 1.6]", "a board at 1.6 m is above 1.2 m"),
    ("kind: shelf,", "kind: sofa,", "only a shelf or a rack has boards"),
    ("kind: shelf,", "mesh: none.glb, kind: shelf,", "write a kind of the catalogue or a mesh"),
    ("board: 2", "board: 3", "'rack' has 2 boards, counted from 1"),
    ("board_of: rack", "board_of: rak", "did you mean rack?"),
    ("board: 2, ", "", "needs the key 'board'"),
    ("board: 2, ", "board: 2, lift: 1 cm, ", "write only sides, color"),
    ("sides: [0]}", "sides: []}", "tables.desk.sides: expected at least 1 value, found 0"),
    ("{kind: mug, on: desk}", "{kind: mug, on: dsk}", "there is no table 'dsk'; did you mean"),
    ("{kind: mug, on: desk}", "{kind: mug, on: desk, size: [1, 1, 1]}", "no size"),
    ("{kind: mug, on: desk}", "{kind: mug, on: desk, radius: 1 cm}", "both radius and height"),
    ("on: low, at: [0, 0]", "on: low", "write on and at, or hung"),
    ("on: low, at: [0, 0]", "hung: [0, 0, 1], turn: 1", "has no shift, yaw and turn"),
    ("on: low, at: [0, 0]", "hung: [0, 0]", "expected [x, y, z], [x, y, z, yaw] or"),
    ("{mark:", "{cup: {id: 2, edge: 1, hung: [0, 0, 1]}, mark:", "'cup' is an object already"),
    ("{post:", "{wall_hall_2: {parts: [{sphere: 1}]}, post:", "is a wall already"),
    ("beside: mark", "beside: mrk", "there is no tag or body 'mrk'; did you mean mark?"),
    ("beside: mark", "beside: cup", "'cup' cannot stand beside itself"),
    ("[{sphere: 10 cm}]", "[{sphere: 10 cm, box: [1, 1, 1]}]", "exactly one of box, cylinder"),
    ("[{sphere: 10 cm}]", "[]", "bodies.post.parts: expected at least 1 value, found 0"),
    ("[{sphere: 10 cm}]", "[{sphere: 10 cm}], mass: 1", "a static body has no mass"),
    ("[{sphere: 10 cm}]", "[{sphere: 10 cm}], static: false", "needs a mass"),
    ("start: {", "light: {ambient: [1, 0]}\nstart: {", "the least, 1, is more than the most, 0"),
    ("start: {", "light: {suns: [{direction: [0, 0, 0]}]}\nstart: {", "is not a direction"),
    ("start: {", "floor: {center: [0, 0]}\nstart: {", "both center and size"),
    ("start: {", "floor: {center: [0, 0], size: [9000, 1]}\nstart: {", "at most 500 m wide"),
    ("start: {", "site: {resolution: 1 mm}\nstart: {", "greater than or equal to 0.01"),
]


@pytest.mark.parametrize(("before", "after", "words"), SECTIONS, ids=lambda c: str(c)[:30])
def test_a_mistake_in_a_section_is_told_once_at_its_line(before, after, words):
    assert STUDIO.count(before) == 1
    text = STUDIO.replace(before, after)
    error = refusal(text)
    assert words in str(error)
    assert len(error.problems) == 1, error
    at = error.problems[0].place
    changed_line = STUDIO[: STUDIO.index(before)].count("\n") + 1
    assert at.line - changed_line in (
        0,
        after.count("\n") - before.count("\n"),
        0,
    )


def test_what_moves_as_the_unknown_says_carries_no_surface():
    text = STUDIO.replace("{kind: shelf,", "{kind: shelf, moves: true,")
    assert "shift and turn it, instead of moves" in str(refusal(text))


def test_more_rooms_than_anybody_draws_are_refused():
    rooms = ", ".join(f"r{i}: {{corner: [{i}, 0], size: [1, 1]}}" for i in range(101))
    text = STUDIO.replace("rooms: {", f"rooms: {{{rooms}, ")
    assert "rooms: " in str(refusal(text))


def test_wrong_values_and_wrong_names_are_told_together():
    text = STUDIO.replace("board: 2", "board: two").replace("on: desk", "on: dsk")
    text = text.replace("beside: mark", "beside: mrk")
    messages = [problem.message for problem in refusal(text).problems]
    assert len(messages) == 3
    assert "tables.low.board: expected a whole number; found 'two'" in messages
    assert any("no table 'dsk'; did you mean desk?" in m for m in messages)
    assert any("no tag or body 'mrk'" in m for m in messages)
    # what is on `low`, which is wrong in itself, is not held against it


def test_after_a_misspelt_section_no_names_are_missed():
    text = STUDIO.replace("tables:", "tabels:")
    (problem,) = refusal(text).problems
    assert "unknown key 'tabels' in the world; did you mean 'tables'?" in problem.message


def with_services(services: str) -> str:
    assert TEXT.count("\nsite:\n") == 1
    return TEXT.replace("\nsite:\n", f"\nsite:\n  services:\n    {services}\n")


TUNED = [
    ("navigat: {speed: 1}", "navigat", ["no service or skill 'navigat'", "did you mean navigate"]),
    ("navigate: {sped: 1}", "sped", ["unknown key 'sped' in site.services.navigate", "'speed'"]),
    ("navigate: {speed: 1 m}", "1 m}", ["site.services.navigate.speed", "expected a speed"]),
    ("navigate: {speed: 50}", "50}", ["less than or equal to 5"]),
    ("localization: {beams: many}", "many", ["site.services.localization.beams"]),
    ("navigate: {controller: {weights: {haste: -1}}}", "-1}", ["controller.weights.haste"]),
    ("planning_scene: {voxl: 1 cm}", "voxl", ["did you mean 'voxel'?"]),
    ("localization: {particles: [400, 200]}", "[400", ["expected the smaller number first"]),
    ("torn: {a: 1}", "torn", ["the set of tunables 'torn'", "cannot be loaded", "doctor"]),
]


@pytest.mark.parametrize(("services", "place", "words"), TUNED, ids=lambda c: str(c)[:25])
def test_a_wrong_tunable_is_named_at_its_place(monkeypatch, services, place, words):
    torn, find = EntryPoint("torn", "no_such_module:Torn", TUNABLES.name), plugins.entry_points
    monkeypatch.setattr(
        plugins,
        "entry_points",
        lambda group: [*find(group), *([torn] if group == TUNABLES.name else [])],
    )
    text = with_services(services)
    error = refusal(text)
    assert len(error.problems) == 1, error
    found = error.problems[0].place
    line = text.splitlines()[found.line - 1]
    assert line[found.column - 1 :].startswith(place), error
    for word in words:
        assert word in str(error)


def test_tunables_that_are_right_reach_the_site():
    world = parse_world(with_services("navigate: {speed: 50 cm/s}"), PATH)
    assert world.site.services == {"navigate": {"speed": "50 cm/s"}}


def test_wrong_tunables_are_told_with_all_other_mistakes():
    text = with_services("navigate: {sped: 1}").replace("  id: 1 ", "  ident: 1 ")
    assert "sped" in str(refusal(text))
    assert "ident" in str(refusal(text))

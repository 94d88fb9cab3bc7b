"""`momantu-bt map show` and `map compare`: what they print and write, and what is wrong input."""

from __future__ import annotations

import json
import os

import numpy as np
import pytest
from momantu_skills.mapping.comparing import align
from momantu_skills.mapping.pictures.raster import known_part, resampled
from momantu_skills.mapping.pictures.terminal import Overlay, map_text
from momantu_skills.navigation.map.maps import GridMap
from PIL import Image

from momantu_bt.cli import main
from momantu_bt.formats.maps import FREE, OCCUPIED, UNKNOWN
from momantu_bt.geometry import Pose2D
from momantu_bt.site_file import Names, TaughtSurface
from tests.skills.mapping.plans import drawn, written
from tests.skills.mapping.walls import RING, box

NAMES = Names(
    start=(1.5, 1.5, 0.0),
    places={"door": (1.5, 1.5, 0.0), "window": (14.0, 10.0, 1.0)},
    surfaces={
        "bench": TaughtSurface(centre=(8.0, 1.5, 0.0), size=(1.0, 0.4), height=0.5, sides=(0.0,)),
        "round_one": TaughtSurface(
            centre=(8.0, 10.5, 0.0), size=(0.8, 0.8), height=0.7, sides=(0.0,), round=True
        ),
    },
)


@pytest.fixture
def folder(tmp_path):
    """A map of one's own, with names and a way."""
    path = tmp_path / "hall"
    path.mkdir()
    written(drawn(RING), path / "map.yaml")
    (path / "site.yaml").write_text(NAMES.text())
    (path / "report.json").write_text(json.dumps({"scans": 2, "way_m": 12.5, "loops": 3}))
    (path / "trajectory.tum").write_text("# way\n0 1.5 1.5 0 0 0 0 1\n1 14 1.5 0 0 0 0 1\n")
    return path


@pytest.fixture
def plan(tmp_path):
    """A map of another program."""
    return written(drawn(RING, 0.1, Pose2D(3.0, 4.0, 0.5)), tmp_path / "foreign.yaml")


def test_a_map_of_ones_own_is_shown_with_way_and_names(folder, tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "72")
    out, figures = tmp_path / "hall.png", tmp_path / "hall.json"
    assert main(["map", "show", str(folder), "-o", str(out), "--json", str(figures)]) == 0
    said = capsys.readouterr().out
    lines = said.splitlines()
    picture = lines[: lines.index(next(line for line in lines if "map.yaml:" in line))]
    assert max(map(len, picture)) <= 72
    assert any("█" in line for line in picture)
    assert sum(line.count("•") for line in picture) >= 1
    assert "way (•) of 12 m, 2 scans, 3 loops" in said
    assert "1 door: (1.50, 1.50), yaw 0.00 rad, place" in said
    assert "bench: (8.00, 1.50), yaw 0.00 rad, surface, 1.00 x 0.40 m, 0.50 m high" in said
    with Image.open(out) as image:
        assert max(image.size) >= 900
    told = json.loads(figures.read_text())
    assert told["names"]["places"]["door"] == [1.5, 1.5, 0.0]
    assert (told["way_m"], told["loops"]) == (12.5, 3)
    cells = drawn(RING).cells
    assert told["free_m2"] == pytest.approx((cells == FREE).sum() * 0.05**2, abs=0.01)
    assert told["size_m"] == [cells.shape[1] * 0.05, cells.shape[0] * 0.05]


def test_a_map_of_another_program_has_neither_way_nor_names(plan, tmp_path, capsys):
    figures = tmp_path / "plan.json"
    assert main(["map", "show", str(plan), "--json", str(figures)]) == 0
    said = capsys.readouterr().out
    assert "cells of 0.1 m" in said
    assert "way" not in said
    told = json.loads(figures.read_text())
    assert (told["way_m"], told["names"]) == (None, None)


def test_two_maps_are_compared(folder, plan, tmp_path, capsys):
    out, figures = tmp_path / "both.png", tmp_path / "both.json"
    given = ["map", "compare", str(folder), str(plan), "-o", str(out), "--json", str(figures)]
    assert main(given) == 0
    said = capsys.readouterr().out
    assert "a_from_b: x" in said
    assert "within 10 cm" in said
    told = json.loads(figures.read_text())
    a_from_b = Pose2D(3.0, 4.0, 0.5).inverse()
    assert told["a_from_b"]["x"] == pytest.approx(a_from_b.x, abs=0.1)
    assert told["a_from_b"]["yaw"] == pytest.approx(-0.5, abs=0.006)
    assert told["in_a"]["agree_10cm"] > 0.97
    assert told["in_b"]["agree_10cm"] > 0.97
    assert told["known_to_both_m2"] > 120.0
    with Image.open(out) as image:
        colors = {color for _, color in image.convert("RGB").getcolors(1_000_000)}
    assert {(0, 0, 0), (255, 255, 255)} <= colors


def test_a_number_that_rounds_to_zero_has_no_sign(folder, monkeypatch, capsys):
    hardly = align.Aligned(Pose2D(-1e-6, -1e-6, -1e-6), 1.0, 1.0, ())
    monkeypatch.setattr(align, "align", lambda *_: hardly)
    assert main(["map", "compare", str(folder), str(folder)]) == 0
    assert "x 0.000 m, y 0.000 m, yaw 0.0000 rad (0.00 deg)" in capsys.readouterr().out


def test_maps_of_different_places_are_told(folder, tmp_path, capsys):
    walls = [*box(0, 0, 4, 30), *box(4, 6, 9, 1.5), *box(-7, 20, 7, 7), *box(1, 2, 1, 1)]
    other = written(drawn(walls), tmp_path / "other.yaml")
    out = tmp_path / "both.png"
    assert main(["map", "compare", str(folder), str(other), "-o", str(out)]) == 1
    assert "do they show the same building?" in capsys.readouterr().out
    assert not out.exists()


def test_doubt_is_told(folder, tmp_path, capsys):
    corridors = [*box(0, 0, 3, 25), *box(1, 4, 8, 1.2), *box(-6, 17, 6, 6)]
    other = written(drawn(corridors), tmp_path / "other.yaml")
    assert main(["map", "compare", str(folder), str(other)]) == 0
    assert "look whether it is the same place" in capsys.readouterr().out


def test_a_map_without_occupied_cells_is_shown_and_not_compared(folder, tmp_path, capsys):
    cells = np.full((20, 30), FREE, np.uint8)
    empty = written(GridMap(cells, 0.05, (0.0, 0.0)), tmp_path / "empty.yaml")
    assert main(["map", "show", str(empty), "-o", str(tmp_path / "empty.png")]) == 0
    capsys.readouterr()
    for pair in ([folder, empty], [empty, folder]):
        assert main(["map", "compare", *map(str, pair)]) == 2
        assert "has no occupied cell" in capsys.readouterr().err


def test_a_map_of_which_nothing_is_known_is_shown(tmp_path, capsys):
    nothing = GridMap(np.full((20, 30), UNKNOWN, np.uint8), 0.05, (0.0, 0.0))
    path = written(nothing, tmp_path / "nothing.yaml")
    assert main(["map", "show", str(path), "-o", str(tmp_path / "nothing.png")]) == 0
    assert "0.0 square metres free, 0.0 occupied, 1.5 unknown" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("resolution: 0.1", "resolution: .nan"), "expected a number"),
        (("resolution: 0.1", "resolution: 0"), "expected metres per pixel above 0"),
        (("image: foreign.pgm", "image: gone.pgm"), "there is no such file"),
        (("image:", "picture:"), "is not a map_server file"),
    ],
)
def test_a_broken_map_is_told(plan, change, said, capsys):
    plan.write_text(plan.read_text().replace(*change))
    for verb in (["show", str(plan)], ["compare", str(plan), str(plan)]):
        assert main(["map", *verb]) == 2
        assert said in capsys.readouterr().err


def test_an_empty_picture_is_told(plan, capsys):
    plan.with_suffix(".pgm").write_bytes(b"")
    assert main(["map", "show", str(plan)]) == 2
    assert "cannot be read" in capsys.readouterr().err


@pytest.mark.parametrize("verb", ["show", "compare"])
def test_a_missing_folder_is_told(folder, verb, capsys):
    near = str(folder.with_name("hal"))
    assert main(["map", verb, *([near] if verb == "show" else [near, str(folder)])]) == 2
    said = capsys.readouterr().err
    assert "there is no such folder or file" in said
    assert "hall" in said


@pytest.mark.parametrize("verb", ["show", "compare"])
@pytest.mark.parametrize(
    ("option", "name", "said"),
    [
        ("-o", "no/where.png", "there is no folder"),
        ("-o", "map.jpg", "is not a .png file"),
        ("--json", "no/where.json", "there is no folder"),
    ],
)
def test_an_output_that_cannot_be_written_is_told(
    folder, plan, tmp_path, verb, option, name, said, capsys
):
    maps = [str(folder)] if verb == "show" else [str(folder), str(plan)]
    before = sorted(os.listdir(tmp_path))
    assert main(["map", verb, *maps, option, str(tmp_path / name)]) == 2
    assert said in capsys.readouterr().err
    assert sorted(os.listdir(tmp_path)) == before


def test_a_broken_way_is_told(folder, capsys):
    (folder / "trajectory.tum").write_text("0 1 2\n")
    assert main(["map", "show", str(folder)]) == 2
    assert "expected rows of 8 numbers" in capsys.readouterr().err


def test_options_of_map_do_not_stand_before_a_sub_verb(folder, capsys):
    assert main(["map", "-o", "x", "show", str(folder)]) == 2
    assert "stand behind its name" in capsys.readouterr().err


def test_who_forgets_show_is_told_of_it(folder, capsys):
    assert main(["map", str(folder)]) == 2
    assert f"To see one: momantu-bt map show {folder}" in capsys.readouterr().err


def test_a_shrunk_map_keeps_its_walls_and_single_cells_do_not_fill_it():
    cells = np.full((100, 100), FREE, np.uint8)
    cells[:, 50] = OCCUPIED
    cells[5, 5] = OCCUPIED
    small = resampled(cells, 10, 10)
    assert (small[:, 5] == OCCUPIED).all()
    assert (small == OCCUPIED).sum() == 10
    large = resampled(cells, 200, 300)
    assert large.shape == (200, 300)
    assert (large == OCCUPIED).mean() == pytest.approx((cells == OCCUPIED).mean())


def test_the_known_part_lies_where_it_did():
    cells = np.full((100, 100), UNKNOWN, np.uint8)
    cells[40:60, 30:50] = FREE
    part = known_part(GridMap(cells, 0.1, (-2.0, 1.0)))
    assert part.origin == pytest.approx((-2.0 + 2.7, 1.0 + 3.7))
    assert part.cells.shape == (26, 26)


@pytest.mark.parametrize(("columns", "rows"), [(20, 10), (80, 24), (3, 1), (200, None)])
def test_a_map_fits_into_the_terminal(columns, rows):
    text = map_text(drawn(RING), columns, rows, Overlay((), Pose2D(1.5, 1.5), {})).plain
    lines = text.splitlines()
    assert max(map(len, lines)) <= columns
    assert rows is None or len(lines) <= rows
    assert columns == 3 or text.count("@") == 1


def test_a_terminal_without_colours_is_served(folder, monkeypatch, capsys):
    monkeypatch.setenv("TERM", "dumb")
    assert main(["map", "show", str(folder)]) == 0
    assert "\x1b" not in capsys.readouterr().out

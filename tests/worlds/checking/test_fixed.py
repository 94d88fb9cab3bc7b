"""A world that varies nothing is checked once; one that varies anything, seed by seed."""

from pathlib import Path

import pytest
from momantu_worlds.checking.fixed import is_fixed
from momantu_worlds.scenes.file.reader import parse_world, read_world
from momantu_worlds.scenes.loading import world_path

from momantu_bt.cli import main

FIXED = """momantu_world: 1
name: still
rooms: {hall: {corner: [0, 0], size: [6, 5]}}
tables: {desk: {kind: desk, at: [3, 4.4, -1.57], size: [0.8, 1.5, 0.72], sides: [0]}}
objects: {cola: {kind: can, on: desk, at: [0.1, 0.1], turn: 0, radius: 0.03, height: 0.1}}
start: {at: [2, 2, 0], turn: 0}
site: {places: {home: [2, 2, 0]}}
"""


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("turn: 0}\nsite", "turn: 0, shift: 0.1}\nsite"),
        ("start: {at: [2, 2, 0], turn: 0}", "start: {at: [2, 2, 0]}"),
        ("at: [0.1, 0.1], turn: 0,", "turn: 0,"),
        ("turn: 0, radius: 0.03, height: 0.1", "turn: 0"),
        ("sides: [0]", "sides: [0], lift: 0.01"),
        ("site:", "distractors: {most: 1}\nsite:"),
        ("site:", "unknown: {}\nsite:"),
        ("site:", "tag: {name: t, id: 1, edge: 0.1, on: desk, at: [0, 0]}\nsite:"),
    ],
)
def test_whatever_varies_is_noticed(old, new):
    assert is_fixed(parse_world(FIXED, Path("still.yaml")))
    assert old in FIXED
    assert not is_fixed(parse_world(FIXED.replace(old, new), Path("still.yaml")))


@pytest.mark.parametrize("name", ["four_rooms", "small_flat", "warehouse"])
def test_the_bundled_worlds_vary(name):
    assert not is_fixed(read_world(world_path(name)))


def test_the_check_says_what_it_does(tmp_path, capsys):
    file = tmp_path / "still.yaml"
    file.write_text(FIXED)
    assert main(["worlds", "check", str(file)]) == 0
    said = capsys.readouterr()
    assert said.out.endswith("nothing is wrong\n")
    assert said.err == f"no seed changes anything in {file}: one is checked\n"
    file.write_text(FIXED.replace("turn: 0}\nsite", "turn: 0.1}\nsite"))
    assert main(["worlds", "check", str(file), "--seeds", "4:6"]) == 0
    assert capsys.readouterr().err == "seed 4, 1 of 2\nseed 5, 2 of 2\n"

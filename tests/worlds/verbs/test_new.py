"""`worlds new`: what it writes is read, is free of findings, and nothing is overwritten."""

from pathlib import Path

import pytest
from momantu_worlds.checking.run import check_world
from momantu_worlds.robots import fetch
from momantu_worlds.scenes.loading import load_world
from momantu_worlds.worlds import world_from_file

from momantu_bt.cli import main

Out = pytest.CaptureFixture[str]


@pytest.mark.parametrize("size", ["6x4", "8x5", "12.5X7", "40x40"])
def test_what_it_writes_is_a_world_of_that_size_and_name(
    tmp_path: Path, capsys: Out, size: str
) -> None:
    file = tmp_path / "my_flat.yaml"
    assert main(["worlds", "new", str(file), "--size", size]) == 0
    assert f"--world {file}" in capsys.readouterr().out
    world = load_world(file)
    assert world.name == "my_flat"
    width, depth = (float(length) for length in size.lower().split("x"))
    corners = [corner for room in world.rooms.values() for corner in room.corners]
    assert max(x for x, _ in corners) - min(x for x, _ in corners) == pytest.approx(width, abs=0.02)
    assert max(y for _, y in corners) - min(y for _, y in corners) == pytest.approx(depth, abs=0.02)


@pytest.mark.parametrize("size", ["6x4", "8x5", "14x6"])
def test_nothing_is_wrong_with_it(tmp_path: Path, size: str) -> None:
    file = tmp_path / "my_flat.yaml"
    assert main(["worlds", "new", str(file), "--size", size]) == 0
    assert check_world(file, world_from_file(file).draw, fetch(), range(4)) == []


def test_a_line_for_the_editor(tmp_path: Path) -> None:
    file = tmp_path / "my_flat.yaml"
    assert main(["worlds", "new", str(file), "--schema", "world.schema.json"]) == 0
    first = file.read_text(encoding="utf-8").splitlines()[0]
    assert first == "# yaml-language-server: $schema=world.schema.json"
    assert load_world(file).name == "my_flat"


@pytest.mark.parametrize(
    ("name", "words", "said"),
    [
        ("there.yaml", [], "exists already"),
        ("new.yaml", ["--size", "8"], "write 8x5"),
        ("new.yaml", ["--size", "3x3"], "between 6x4 and 40x40 m"),
        ("new.yaml", ["--size", "50x50"], "between 6x4 and 40x40 m"),
        ("new.txt", [], "is not a .yaml file"),
        ("My-Flat.yaml", [], "is not a name for a world"),
        ("none/new.yaml", [], "cannot be written"),
    ],
)
def test_what_it_refuses(
    tmp_path: Path, capsys: Out, name: str, words: list[str], said: str
) -> None:
    (tmp_path / "there.yaml").write_text("mine", encoding="utf-8")
    assert main(["worlds", "new", str(tmp_path / name), *words]) == 2
    assert said in capsys.readouterr().err
    assert [p.name for p in tmp_path.iterdir()] == ["there.yaml"]
    assert (tmp_path / "there.yaml").read_text(encoding="utf-8") == "mine"

"""A world is named by its file wherever worlds are named, and by a tree beside itself."""

from __future__ import annotations

import json

import numpy as np
import pytest
import trimesh

from momantu_bt.bench.planning.made_of import difference, made_of
from momantu_bt.cli import main
from momantu_bt.formats.maps import MapPicture, write_map
from momantu_bt.tree.check.named_world import world_of
from momantu_bt.tree.load import load
from momantu_bt.tree.registry import Registry
from momantu_bt.world_plugins import WORLDS

TREE = "momantu_bt: 1\n{world}trees:\n  Main:\n    - navigate: home\n"
WORLD = {
    "momantu_world": 1,
    "name": "yard",
    "rooms": {"yard": {"corner": [0, 0], "size": [6, 5]}},
    "start": {"at": [2, 2, 0]},
    "site": {"places": {"home": [3, 2, 0]}},
}


@pytest.fixture
def yard(tmp_path):
    """`yard(**parts)` writes a world file in a folder of its own."""
    (tmp_path / "rooms").mkdir()

    def write(**parts):
        path = tmp_path / "rooms" / "yard.yaml"
        path.write_text(json.dumps({**WORLD, **parts}, indent=1), encoding="utf-8")
        return path

    return write


@pytest.fixture
def tree(tmp_path):
    """`tree(world)` writes a tree that names a world."""
    (tmp_path / "trees").mkdir()

    def write(world=None):
        path = tmp_path / "trees" / "tree.yaml"
        path.write_text(TREE.format(world=f"world: {world}\n" if world else ""), encoding="utf-8")
        return str(path)

    return write


def test_a_file_and_a_name_are_the_same_kind_of_thing(yard, monkeypatch):
    path, registry = yard(), Registry.installed()
    entry = registry.worlds[str(path)]
    assert entry.name == "yard"
    assert entry.default_robot == "fetch"
    assert "home" in entry.site().places
    assert str(path) in registry.worlds
    monkeypatch.chdir(path.parent)
    assert registry.worlds["yard.yaml"].site() == entry.site()
    assert WORLDS.absolute("yard.yaml") == str(path)


def test_a_tree_names_a_world_beside_itself_from_wherever_it_is_run(yard, tree, monkeypatch):
    path = yard()
    file = tree("../rooms/yard.yaml")
    monkeypatch.chdir(path.anchor)
    document = load(file).document
    assert document.world == "../rooms/yard.yaml"
    assert (path.parent.parent / "trees" / world_of(document, None)).resolve() == path
    assert world_of(document, "four_rooms") == "four_rooms"
    assert world_of(document, "none") is None
    assert main(["check", file]) == 0


def test_a_place_that_the_world_lacks_is_told(yard, tree, capsys):
    yard(site={"places": {"gate": [3, 2, 0]}})
    assert main(["check", tree("../rooms/yard.yaml")]) == 2
    assert "home" in capsys.readouterr().err


def test_what_is_wrong_with_the_file_is_told_with_its_own_place(yard, tree, capsys):
    path = yard(start={"at": [2, 2]})
    assert main(["check", tree(), "--world", str(path)]) == 2
    said = capsys.readouterr().err
    assert f"{path}:" in said
    assert "start.at: expected 3 values, found 2" in said


def test_a_file_that_is_not_there_and_a_bare_name_get_hints(yard, tree, monkeypatch, capsys):
    path = yard()
    assert main(["check", tree(), "--world", str(path.parent / "yrad.yaml")]) == 2
    assert "files there: yard.yaml" in capsys.readouterr().err
    monkeypatch.chdir(path.parent)
    assert main(["check", tree(), "--world", "yard"]) == 2
    assert "write ./yard.yaml" in capsys.readouterr().err


def test_a_world_of_a_robot_file_names_it_from_its_own_folder(yard):
    path = yard(robot="../robots/carter/robot.yaml")
    entry = Registry.installed().worlds[str(path)]
    assert entry.default_robot == str(path.parent / "../robots/carter/robot.yaml")


def test_another_text_and_another_mesh_are_another_episode(yard, tree):
    registry = Registry.installed()
    path = yard()
    box = path.parent / "box.stl"
    trimesh.creation.box((1, 1, 1)).export(box)
    furniture = {"box": {"mesh": "box.stl", "at": [5, 4, 0]}}
    path = yard(furniture=furniture)
    document = load(tree(), registry, world=str(path)).document

    def made():
        return made_of(document, registry, world=str(path))

    first = made()
    assert first["the world"] == "yard"
    assert first == made()
    trimesh.creation.box((1, 1, 2)).export(box)
    assert difference(first, made()) == ("the world's file box.stl",)
    yard(furniture=furniture, start={"at": [2, 2.5, 0]})
    changed = difference(first, made())
    assert changed == ("the world's file yard.yaml", "the world's file box.stl")


def test_a_goal_outside_a_worlds_own_map(yard, tmp_path, capsys):
    levels = np.full((100, 120), 254)
    levels[:, :20] = 0
    write_map(tmp_path / "rooms" / "plan.yaml", MapPicture(levels, 0.05, (0.0, 0.0)))
    path = yard(site={**WORLD["site"], "map": "plan.yaml"})
    tree = tmp_path / "tree.yaml"
    told = {"x: 9, y: 2": "outside-map", "x: 0.5, y: 2": "goal-blocked", "x: 3, y: 2": ""}
    for at, code in told.items():
        text = TREE.format(world="").replace("home", f"{{goal: {{{at}}}}}")
        tree.write_text(text, encoding="utf-8")
        assert main(["check", str(tree), "--world", str(path)]) == (2 if code else 0)
        assert f"[{code}]" in capsys.readouterr().err or not code

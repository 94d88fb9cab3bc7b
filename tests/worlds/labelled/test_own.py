"""A category made from a folder of meshes: kept for testing, lying, wrong folders."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from momantu_skills.perception.learned.detector import WEIGHTS, LearnedDetector
from momantu_skills.perception.learned.weights import BUNDLED
from momantu_worlds.labelled.heaps import resting
from momantu_worlds.labelled.own import own_category
from momantu_worlds.labelled.own_files import named_meshes
from momantu_worlds.labelled.stock import Stock
from momantu_worlds.labelled.studio import Studio

from momantu_bt import labelled
from momantu_bt.categories import USUAL, Symmetry
from momantu_bt.cli import main
from momantu_bt.errors import InputError
from momantu_bt.world import WorldError, seeded


def spray(high: float) -> trimesh.Trimesh:
    """A round body with a nozzle to one side, in mm."""
    body = trimesh.creation.cylinder(30.0, high)
    nozzle = trimesh.creation.box((70.0, 15.0, 15.0))
    nozzle.apply_translation((30.0, 0.0, high / 2 + 7.0))
    return trimesh.util.concatenate([body, nozzle])


@pytest.fixture
def sprays(tmp_path: Path) -> Path:
    """A folder with five meshes in mm, of several kinds of file."""
    folder = tmp_path / "sprays"
    folder.mkdir()
    for number, ending in enumerate(("obj", "stl", "ply", "glb", "stl")):
        spray(130.0 + 10.0 * number).export(folder / f"spray_{number}.{ending}")
    return folder


def test_every_fourth_mesh_is_kept_for_testing(sprays: Path) -> None:
    made = own_category("spray", sprays, 0.001, testing=True)
    assert [model.shape.family for model in made.testing] == ["spray_3"]
    assert len(made.training) == 4
    assert made.symmetry is Symmetry.NONE
    assert made.training[0].shape.size == pytest.approx((0.095, 0.06, 0.1445), abs=1e-3)
    for testing in (False, True):
        drawn = {made.shape(seeded(n), testing=testing).family for n in range(30)}
        assert drawn == {m.shape.family for m in (made.testing if testing else made.training)}


@pytest.mark.parametrize("count", [2, 3])
def test_of_few_meshes_the_last_is_kept(count: int, sprays: Path) -> None:
    for file in sorted(sprays.iterdir())[count:]:
        file.unlink()
    made = own_category("spray", sprays, 0.001, testing=True)
    assert [model.shape.family for model in made.testing] == [f"spray_{count - 1}"]


def test_round_meshes_are_known_as_such(tmp_path: Path) -> None:
    trimesh.creation.cone(0.04, 0.15).export(tmp_path / "cone.stl")
    trimesh.creation.annulus(0.02, 0.05, 0.03).export(tmp_path / "ring.ply")
    made = own_category("toy", tmp_path, testing=False)
    assert made.symmetry is Symmetry.ROUND
    trimesh.creation.box((0.05, 0.05, 0.1)).export(tmp_path / "block.ply")
    assert own_category("toy", tmp_path, testing=False).symmetry is Symmetry.NONE


def test_a_mesh_rests_on_the_surface_and_would_not_tip_over(sprays: Path) -> None:
    made = own_category("spray", sprays, 0.001, testing=False)
    leaning = 0
    for number in range(40):
        draw = seeded("rest", number)
        shape = made.shape(draw, testing=False)
        pose = resting(draw, shape)
        there = pose.apply(shape.outline)
        assert there[:, 2].min() == pytest.approx(0.0, abs=1e-6)
        carrying = there[there[:, 2] < 0.004][:, :2]
        assert len(carrying) >= 3
        middle = pose.apply(shape.outline.mean(axis=0))[:2]
        assert (carrying.min(axis=0) - 0.005 < middle).all()
        assert (carrying.max(axis=0) + 0.005 > middle).all()
        leaning += pose.rotation[2, 2] < 0.9
    assert 5 < leaning < 30


def test_from_meshes_to_weights_that_know_the_category(
    sprays: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "pictures"
    command = ["perception", "render", "-o", str(out), "--seeds", "0:3", "--world", "four_rooms"]
    own = ["--meshes", str(sprays), "--category", "spray", "--scale", "0.001"]
    assert main([*command, *own]) == 0
    assert labelled.categories_in(out) == {**USUAL, "spray": Symmetry.NONE}
    made = [labelled.read(out, seed) for seed in labelled.seeds_in(out)]
    assert sum(thing.category == "spray" for one in made for thing in one.things) >= 2
    mine = tmp_path / "mine.safetensors"
    train = ["perception", "train", str(out), "-o", str(mine), "--epochs", "1"]
    assert main([*train, "--start", str(BUNDLED)]) == 0
    assert LearnedDetector(mine).categories == (*USUAL, "spray")
    monkeypatch.setenv(WEIGHTS, str(mine))
    told = tmp_path / "told.json"
    evaluate = ["perception", "evaluate", "--detector", "learned", "--pictures", str(out)]
    assert main([*evaluate, "--seeds", "0:3", "--json", str(told)]) == 0
    assert "spray" in json.loads(told.read_text())


def test_without_meshes_the_pictures_stay_as_they_are(sprays: Path) -> None:
    stock = Stock(testing=False)
    assert dict(stock.categories) == dict(USUAL)
    made = own_category("spray", sprays, 0.001, testing=False)
    assert "spray" in Studio(["four_rooms"], testing=False, own=(made,)).picture(0).categories
    assert "spray" not in Studio(["four_rooms"], testing=False).picture(0).categories


def test_what_is_wrong_with_meshes_is_told(sprays: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"spray_0.obj is 95 x 60 x 144 m.*--scale"):
        own_category("spray", sprays, testing=False)
    with pytest.raises(InputError, match="expected a word"):
        own_category("bottle", sprays, 0.001, testing=False)
    with pytest.raises(InputError, match="no such folder"):
        own_category("spray", tmp_path / "nowhere", testing=False)
    empty = tmp_path / "empty"
    empty.mkdir()
    with pytest.raises(InputError, match="holds no mesh"):
        own_category("spray", empty, testing=False)
    (sprays / "spray_1.stl").write_text("no mesh")
    with pytest.raises(WorldError, match=r"spray_1\.stl"):
        own_category("spray", sprays, 0.001, testing=False)


def test_each_mesh_may_have_a_folder_of_its_own(sprays: Path, tmp_path: Path) -> None:
    for number in range(3):
        folder = tmp_path / "set" / f"thing_{number}" / "deep"
        folder.mkdir(parents=True)
        spray(130.0 + number).export(folder / "model.ply")
    found = named_meshes(tmp_path / "set")
    assert [name for name, _ in found] == [f"thing_{number}/deep/model" for number in range(3)]
    assert found[1][1] == tmp_path / "set" / "thing_1" / "deep" / "model.ply"
    made = own_category("spray", tmp_path / "set", 0.001, testing=True)
    assert [model.shape.family for model in made.testing] == ["thing_2/deep/model"]
    spray(140.0).export(tmp_path / "set" / "thing_1" / "deep" / "collision.ply")
    with pytest.raises(InputError, match=r"thing_1 holds 2 meshes \(deep/collision.ply, .*pattern"):
        named_meshes(tmp_path / "set")
    assert named_meshes(tmp_path / "set" / "*" / "deep" / "model.ply") == found


def test_a_pattern_that_matches_nothing_is_told(sprays: Path) -> None:
    assert [name for name, _ in named_meshes(sprays / "*.stl")] == ["spray_1", "spray_4"]
    with pytest.raises(InputError, match="matches no mesh"):
        named_meshes(sprays / "*.blend")


def test_one_mesh_can_be_trained_on_but_not_tested(sprays: Path) -> None:
    for file in sorted(sprays.iterdir())[1:]:
        file.unlink()
    assert len(own_category("spray", sprays, 0.001, testing=False).training) == 1
    with pytest.raises(InputError, match="none is kept for testing"):
        own_category("spray", sprays, 0.001, testing=True)


def test_the_command_tells_wrong_options(sprays: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["perception", "render", "-o", str(sprays / "out"), "--seeds", "0:1"]
    assert main([*command, "--meshes", str(sprays)]) == 2
    assert "give a category for each folder" in capsys.readouterr().err
    twice = ["--meshes", str(sprays), "--category", "spray"]
    assert main([*command, *twice, *twice]) == 2
    assert "one category twice" in capsys.readouterr().err
    assert main([*command, *twice, "--up", "x"]) == 2
    assert "expected z or y" in capsys.readouterr().err


def test_folders_that_disagree_about_a_category_are_told(sprays: Path, tmp_path: Path) -> None:
    made = own_category("spray", sprays, 0.001, testing=False)
    picture = Studio(["four_rooms"], testing=False, own=(made,)).picture(0)
    labelled.write(tmp_path, picture)
    text = (tmp_path / "000000.json").read_text()
    other = text.replace('"spray": "none"', '"spray": "round"')
    (tmp_path / "000001.json").write_text(other)
    with pytest.raises(labelled.LabelledError, match="with the symmetry round"):
        labelled.categories_in(tmp_path)
    assert np.isfinite(picture.image.depth).all()

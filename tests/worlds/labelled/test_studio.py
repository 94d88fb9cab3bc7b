"""Labelled pictures: what the labels say is what the pictures show; files; the command."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from momantu_worlds.labelled.studio import Studio

from momantu_bt import labelled
from momantu_bt.cli import main
from momantu_bt.labelled import Labelled, LabelledError
from momantu_bt.plugins import PluginError

SEEDS = (0, 1, 2)


@pytest.fixture(scope="module")
def pictures() -> dict[int, Labelled]:
    """Some pictures of one world."""
    studio = Studio(["four_rooms"], testing=False)
    return {seed: studio.picture(seed) for seed in SEEDS}


def cloud(made: Labelled) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) of labelled pixels in the optical frame, m, and their numbers."""
    depth, k = made.image.depth, made.image.intrinsics
    v, u = np.nonzero((made.numbers > 0) & (depth > 0))
    z = depth[v, u].astype(np.float64)
    x, y = (u - k[0, 2]) / k[0, 0] * z, (v - k[1, 2]) / k[1, 1] * z
    return np.column_stack([x, y, z]), made.numbers[v, u]


def test_pixels_of_a_thing_lie_on_it(pictures: dict[int, Labelled]) -> None:
    for made in pictures.values():
        points, numbers = cloud(made)
        for thing in made.things:
            own = thing.camera_from_object.inverse().apply(points[numbers == thing.number])
            half = np.array(thing.size) / 2
            across = np.abs(own[:, 1:]) - half[1:]
            assert (across < 0.02).all(axis=1).mean() > 0.97, thing
            if thing.category != "mug":  # its handle
                assert (np.abs(own[:, 0]) - half[0] < 0.02).mean() > 0.97, thing
            assert np.count_nonzero(made.numbers == thing.number) == thing.seen


def test_the_told_camera_sees_the_things_on_the_surface(pictures: dict[int, Labelled]) -> None:
    for made in pictures.values():
        points, _ = cloud(made)
        heights = made.odom_from_camera.apply(points)[:, 2] - made.height
        assert np.percentile(heights, 1) > -0.02
        assert np.percentile(heights, 99) < 0.45


def test_a_seed_gives_the_same_picture_whatever_was_before(pictures: dict[int, Labelled]) -> None:
    again = Studio(["four_rooms"], testing=False).picture(SEEDS[-1])
    there = pictures[SEEDS[-1]]
    assert np.array_equal(again.image.color, there.image.color)
    assert np.array_equal(again.image.depth, there.image.depth)
    assert np.array_equal(again.numbers, there.numbers)
    assert again.things == there.things


def test_more_pictures_of_a_seed_show_the_same_things_from_elsewhere(
    pictures: dict[int, Labelled],
) -> None:
    first, *more = Studio(["four_rooms"], testing=False).pictures(0, 3)
    assert np.array_equal(first.image.color, pictures[0].image.color)
    assert more
    for other in more:
        apart = other.odom_from_camera.position - first.odom_from_camera.position
        assert np.linalg.norm(apart) > 0.05
        there = {thing.number: thing for thing in other.things}
        assert there.keys() & {thing.number for thing in first.things}
        for thing in first.things:
            if thing.number in there:
                one = first.odom_from_camera @ thing.camera_from_object
                two = other.odom_from_camera @ there[thing.number].camera_from_object
                assert np.linalg.norm(one.position - two.position) < 0.04
                assert thing.size == there[thing.number].size


def test_testing_shows_other_families(pictures: dict[int, Labelled]) -> None:
    tested = Studio(["four_rooms"], testing=True).picture(0)
    trained = {thing.family for made in pictures.values() for thing in made.things}
    own = {(thing.category, thing.family) for thing in tested.things}
    assert own.isdisjoint({(t.category, t.family) for m in pictures.values() for t in m.things})
    assert trained


def test_files_hold_the_whole_picture(pictures: dict[int, Labelled], tmp_path: Path) -> None:
    made = pictures[1]
    labelled.write(tmp_path, made)
    back = labelled.read(tmp_path, 1)
    assert labelled.seeds_in(tmp_path) == (1,)
    assert back.things == made.things
    assert np.array_equal(back.numbers, made.numbers)
    assert np.abs(back.image.depth - made.image.depth).max() < 1e-6
    assert np.abs(back.image.color.astype(int) - made.image.color).mean() < 6
    assert np.array_equal(back.image.intrinsics, made.image.intrinsics)


@pytest.mark.parametrize("damage", ["missing", "version", "cut", "chunk", "list", "label"])
def test_damaged_files_are_told(damage: str, pictures: dict[int, Labelled], tmp_path: Path) -> None:
    labelled.write(tmp_path, pictures[0])
    text = tmp_path / "000000.json"
    if damage == "missing":
        (tmp_path / "000000.jpg").unlink()
    elif damage == "version":
        text.write_text(text.read_text().replace('"momantu_labels": 1', '"momantu_labels": 7'))
    elif damage == "cut":
        depth = tmp_path / "000000.depth.png"
        depth.write_bytes(depth.read_bytes()[:2000])
    elif damage == "chunk":
        things = tmp_path / "000000.things.png"
        things.write_bytes(things.read_bytes().replace(b"IDAT", b"\xaf\xbea2", 1))
    elif damage == "list":
        text.write_text("[]")
    else:
        text.write_text(text.read_text().replace('"number"', '"nummer"'))
    with pytest.raises(LabelledError, match="render seed 0 again"):
        labelled.read(tmp_path, 0)


def test_render_goes_on_where_it_ended(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["perception", "render", "-o", str(tmp_path), "--world", "small_flat", "--seeds"]
    assert main([*command, "0:1"]) == 0
    first = (tmp_path / "000000.depth.png").stat().st_mtime_ns
    assert main([*command, "0:2"]) == 0
    assert "1 of 2 pictures are there" in capsys.readouterr().err
    assert (tmp_path / "000000.depth.png").stat().st_mtime_ns == first
    assert labelled.seeds_in(tmp_path) == (0, 1)


def test_an_unknown_world_is_told(tmp_path: Path) -> None:
    with pytest.raises(PluginError, match="four_room"):
        Studio(["four_romms"], testing=False)

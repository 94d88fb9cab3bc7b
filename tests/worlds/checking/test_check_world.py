"""A whole world checked: findings of several episodes are one, at their place in the file."""

from dataclasses import replace
from pathlib import Path

import pytest
from momantu_worlds.checking.run import check_world
from momantu_worlds.robots import fetch
from momantu_worlds.scenes.arrange.mesh_files import MeshError
from momantu_worlds.scenes.geometry.bodies import Episode
from momantu_worlds.scenes.loading import draw_episode, world_path

from momantu_bt.geometry import Pose2D
from momantu_bt.world import WorldError

PATH = world_path("four_rooms")
LINES = PATH.read_text(encoding="utf-8").splitlines()


def test_a_crate_that_reaches_into_a_wall_is_told_once_for_all_seeds(tmp_path: Path) -> None:
    pushed = tmp_path / "pushed.yaml"
    text = PATH.read_text(encoding="utf-8")
    crate = "crate_corridor: {kind: crate, at: [-8.20, "
    assert f"{crate}1.35," in text
    pushed.write_text(text.replace(f"{crate}1.35,", f"{crate}1.40,"), encoding="utf-8")
    findings = check_world(pushed, lambda seed: draw_episode(pushed, seed), fetch(), range(3))
    (finding,) = findings
    assert (finding.severity.label, finding.code) == ("warning", "overlap")
    assert finding.place.file == str(pushed)
    assert "crate_corridor overlaps wall_corridor_north_west by 3.8 cm" in finding.message
    assert LINES[finding.place.line - 1].startswith("  crate_corridor:")
    assert finding.seeds == (1, 2)


@pytest.mark.parametrize("world", ["four_rooms", "small_flat", "warehouse"])
def test_nothing_is_wrong_with_a_world_that_comes_along(world: str) -> None:
    path = world_path(world)
    assert check_world(path, lambda seed: draw_episode(world, seed), fetch(), range(6)) == []


def test_the_worst_episode_words_a_finding_and_one_that_cannot_be_is_told() -> None:
    drawn = draw_episode("four_rooms", 0)
    wall = drawn.body("wall_outer_west").map_from_body.position

    def draw(seed: int) -> Episode:
        if seed == 2:
            raise WorldError("no free place to start")
        return replace(drawn, start=Pose2D(float(wall[0]) + (0.1, 0.2)[seed], 0.9, 0.0))

    found = {finding.code: finding for finding in check_world(PATH, draw, fetch(), range(3))}
    start = found["start-in-collision"]
    assert start.seeds == (0, 1)
    assert LINES[start.place.line - 1].startswith("  at: [-4.70")
    depth = 0.075 + 0.29 - 0.1
    assert f"{100 * depth:.0f} cm inside wall_outer_west" in start.message
    assert found["no-episode"].seeds == (2,)
    assert "no free place to start" in found["no-episode"].message


def test_a_mesh_that_cannot_be_read_is_no_lack_of_room() -> None:
    def draw(seed: int) -> Episode:
        raise MeshError("the mesh file tin.ply holds no triangles")

    with pytest.raises(MeshError, match="no triangles"):
        check_world(PATH, draw, fetch(), range(3))


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("table_a", "  table_a:"),
        ("can", "item:"),
        ("tag", "tag:"),
        ("wall_outer_west", "    - {name: outer_west"),
        ("entrance", "  entrance:"),
        ("extra_plant_0", "unknown:"),
        ("table_a_mug_1", "distractors:"),
    ],
)
def test_where_a_body_comes_from(name: str, line: str) -> None:
    from momantu_worlds.checking.where import Where

    where = Where(PATH)
    number = where.at(where.body(name)).line
    assert LINES[number - 1].startswith(line)

"""A world from a floor plan: solid exactly where the map is occupied; a copy of a world works."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from momantu_worlds.scenes.geometry.bodies import Episode
from momantu_worlds.scenes.geometry.solids import Scene
from momantu_worlds.scenes.loading import draw_episode, load_world
from numpy.typing import NDArray

from momantu_bt.cli import main
from momantu_bt.formats.maps import FREE, OCCUPIED, UNKNOWN, MapPicture, write_map

Out = pytest.CaptureFixture[str]
RESOLUTION, ORIGIN = 0.1, (-3.0, -2.0)


def rooms(rough: bool) -> NDArray[np.uint8]:
    """Two rooms with a door of 1.2 m, seen from inside: unknown around them."""
    cells = np.full((60, 100), UNKNOWN, dtype=np.uint8)
    cells[5:55, 5:95] = OCCUPIED
    cells[7:53, 7:93] = FREE
    cells[7:53, 50:52] = OCCUPIED
    cells[24:36, 50:52] = FREE
    if rough:  # as a laser draws walls, so that it takes many boxes
        random = np.random.default_rng(1)
        for row in (8, 10, 49, 51):
            cells[row, 7:50] = np.where(random.random(43) < 0.5, OCCUPIED, FREE)
    return cells


def plan_of(folder: Path, cells: NDArray[np.uint8]) -> Path:
    levels = np.array([254, 0, 205], dtype=np.uint8)[cells[::-1]]
    file = folder / "map.yaml"
    write_map(file, MapPicture(levels, RESOLUTION, ORIGIN))
    return file


def solid(episode: Episode, points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which points (n, 3) are inside any body but the floor."""
    bodies = {body.name: body for body in episode.bodies if body.name != "floor"}
    scene = Scene(bodies, lambda name: bodies[name].map_from_body)
    return np.any([scene.body(name).inside(points) for name in bodies], axis=0)


@pytest.mark.parametrize("rough", [False, True])
def test_it_is_solid_where_the_map_is_occupied(tmp_path: Path, capsys: Out, rough: bool) -> None:
    cells, world = rooms(rough), tmp_path / "building.yaml"
    file = plan_of(tmp_path, cells)
    assert main(["worlds", "import", str(file), "-o", str(world), "--height", "3"]) == 0
    assert ("0 meshes" in capsys.readouterr().out) is not rough
    rows, columns = np.indices(cells.shape)
    middles = (np.stack([columns, rows], axis=-1).reshape(-1, 2) + 0.5) * RESOLUTION + ORIGIN
    episode = draw_episode(world, 0)
    for height, walls in ((0.1, True), (2.9, True), (3.1, False)):
        points = np.column_stack([middles, np.full(len(middles), height)])
        np.testing.assert_array_equal(solid(episode, points), (cells.ravel() == OCCUPIED) & walls)


def test_the_robot_starts_on_free_floor_and_gets_the_map(tmp_path: Path) -> None:
    cells, world = rooms(rough=False), tmp_path / "worlds" / "building.yaml"
    world.parent.mkdir()
    assert main(["worlds", "import", str(plan_of(tmp_path, cells)), "-o", str(world)]) == 0
    loaded = load_world(world)
    assert loaded.site.map == "../map.yaml"
    assert {file.name for file in loaded.files()} == {"building.yaml", "map.yaml", "map.pgm"}
    for pose in loaded.site.places.values():
        column, row = ((np.array(pose[:2]) - ORIGIN) / RESOLUTION).astype(int)
        around = cells[row - 3 : row + 4, column - 3 : column + 4]
        assert (around == FREE).all()


@pytest.mark.parametrize(
    ("cells", "said"),
    [
        (np.full((50, 50), OCCUPIED, np.uint8), "no robot can stand anywhere"),
        (np.full((50, 50), UNKNOWN, np.uint8), "no robot can stand anywhere"),
    ],
)
def test_a_plan_without_free_floor_is_refused(
    tmp_path: Path, capsys: Out, cells: NDArray[np.uint8], said: str
) -> None:
    world = tmp_path / "building.yaml"
    assert main(["worlds", "import", str(plan_of(tmp_path, cells)), "-o", str(world)]) == 2
    assert said in capsys.readouterr().err
    assert not world.exists()


def test_the_map_itself_is_not_overwritten(tmp_path: Path, capsys: Out) -> None:
    file = plan_of(tmp_path, rooms(rough=False))
    before = file.read_bytes()
    assert main(["worlds", "import", str(file), "-o", str(file), "--force"]) == 2
    assert "the map itself" in capsys.readouterr().err
    assert file.read_bytes() == before


def test_a_yaml_file_that_is_no_map_is_told(tmp_path: Path, capsys: Out) -> None:
    file = tmp_path / "tree.yaml"
    file.write_text("momantu_bt: 1\n")
    assert main(["worlds", "import", str(file), "-o", str(tmp_path / "world.yaml")]) == 2
    assert "is not a map_server file" in capsys.readouterr().err

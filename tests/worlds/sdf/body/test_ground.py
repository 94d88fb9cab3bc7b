"""The floor of an imported world where it is a mesh."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

GROUND = "<include><uri>model://ground_plane</uri></include>"


@pytest.fixture
def building(tmp_path: Path):
    """`building(height)`: a model of one mesh: a floor 8 x 6 m, a wall, a stage on it."""

    def write(height: float, floor: float = 8.0) -> str:
        parts = [
            trimesh.creation.box((floor, 6.0, 0.02), trimesh.transformations.translation_matrix(at))
            for at in [(0.0, 0.0, -0.01)]
        ]
        wall = trimesh.creation.box((8.0, 0.1, 2.0))
        wall.apply_translation((0.0, 3.0, 1.0))
        stage = trimesh.creation.box((2.0, 2.0, 0.3))
        stage.apply_translation((2.0, 0.0, 0.15))
        mesh = trimesh.util.concatenate([*parts, wall, stage])
        mesh.export(tmp_path / "house.stl")
        shape = "<geometry><mesh><uri>house.stl</uri></mesh></geometry>"
        return (
            f"<model name='house'><static>1</static><pose>0 0 {height} 0 0 0</pose><link name='l'>"
            f"<visual name='v'>{shape}</visual>"
            f"<collision name='c'>{shape}</collision></link></model>"
        )

    return write


def height_of(found, name):
    body = next(body for body in found.world.bodies if body.name == name)
    return float(body.at.position[2])


@pytest.mark.parametrize("height", [0.1, 0.3])
def test_a_wide_mesh_above_the_ground_is_the_floor(imported, box, building, height):
    things = building(height) + box("crate", "1 1 1", f"-2 0 {height + 0.5} 0 0 0")
    found = imported(GROUND + things)
    assert found.world.ground.height == pytest.approx(height, abs=0.006)
    assert height_of(found, "house") == pytest.approx(0.0, abs=0.006)
    assert height_of(found, "house") > 0.0, "else it is not seen"
    assert height_of(found, "crate") == pytest.approx(0.5, abs=0.006)
    said = [deviation.instead for deviation in found.deviations]
    assert any("it is left out: the floor lies" in text for text in said)


def test_without_a_ground_the_mesh_alone_is_the_floor(imported, box, building):
    found = imported(building(0.4) + box("crate", "1 1 1", "-2 0 0.9 0 0 0"))
    assert height_of(found, "crate") == pytest.approx(0.5, abs=0.006)


@pytest.mark.parametrize("height", [0.0, -0.2])
def test_a_mesh_that_is_not_above_the_ground_changes_nothing(imported, box, building, height):
    found = imported(GROUND + building(height) + box("crate", "1 1 1", "-2 0 0.5 0 0 0"))
    assert found.world.ground.height == 0.0
    assert height_of(found, "crate") == pytest.approx(0.5)


def test_neither_a_narrow_mesh_nor_one_high_up_is_the_floor(imported, box, building):
    crate = box("crate", "1 1 1", "-5 -5 0.5 0 0 0") + box("far", "1 1 1", "5 5 0.5 0 0 0")
    assert imported(GROUND + crate + building(0.2, floor=2.0)).world.ground.height == 0.0
    assert imported(GROUND + crate + building(0.8)).world.ground.height == 0.0


def test_the_walls_of_a_mesh_with_a_floor_still_stand(imported, building):
    found = imported(GROUND + building(0.1))
    (house,) = found.world.bodies
    tops = np.concatenate(list(house.hulls()))[:, 2]
    assert tops.max() == pytest.approx(2.0, abs=0.01)

"""What a view leaves out: the upper part of walls, lintels and roofs, and nothing else."""

from dataclasses import replace

import pytest
from momantu_worlds.preview.view import CUT, as_model
from momantu_worlds.scenes.geometry.bodies import Body, Box, Cylinder, Part
from momantu_worlds.testing import plain_episode

from momantu_bt.geometry import Transform


def box(size: tuple[float, float, float], z: float) -> Part:
    return Part(Box(size), Transform((0.0, 0.0, z)))


def modelled(body: Body) -> Body:
    return as_model(replace(plain_episode(), bodies=(body,))).bodies[0]


def heights(body: Body) -> list[tuple[float, float]]:
    """Bottom and top of each of its boxes, m."""
    found = []
    for part in body.parts:
        assert isinstance(part.geometry, Box)
        middle = float((body.map_from_body @ part.body_from_part).position[2])
        half = part.geometry.size[2] / 2
        found.append((pytest.approx(middle - half), pytest.approx(middle + half)))
    return found


@pytest.mark.parametrize("z", [0.0, 0.4])
def test_a_wall_is_cut_and_its_lintel_is_left_out(z: float) -> None:
    parts = (box((4.0, 0.1, 2.5), 1.25), box((1.0, 0.1, 0.5), 2.25))
    wall = Body("wall", "wall", Transform((1.0, 2.0, z)), parts)
    assert heights(modelled(wall)) == [(z, CUT)]


def test_a_low_wall_and_what_is_no_upright_box_stay() -> None:
    low = Body("low", "wall", Transform(), (box((4.0, 0.1, 1.0), 0.5),))
    column = Body("column", "wall", Transform(), (Part(Cylinder(0.2, 2.5)),))
    leaning = Transform.from_rpy((0, 0, 1), (0.2, 0, 0))
    for body in (low, column, replace(low, map_from_body=leaning)):
        assert modelled(body) == body


def test_a_roof_is_left_out_and_a_tall_shelf_is_not() -> None:
    roof, shelf = box((4.0, 4.0, 0.1), 2.4), box((0.4, 2.0, 2.2), 1.1)
    lamp = box((0.2, 2.0, 0.1), 2.3)
    house = Body("house", "body", Transform(), (roof, shelf, lamp))
    assert modelled(house).parts == (shelf, lamp)
    loose = replace(house, static=False, mass=1.0)
    assert modelled(loose) == loose

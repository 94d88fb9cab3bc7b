"""The site's map is what the world file says, in map_server's format."""

import numpy as np
import pytest
from momantu_worlds.robots import fetch
from momantu_worlds.scenes.arrange.obstacles import wall_rectangles
from momantu_worlds.scenes.loading import load_world
from momantu_worlds.scenes.site.floor_plan import (
    FREE,
    OCCUPIED,
    UNKNOWN,
    cells_of,
    draw_plans,
)

from momantu_bt.formats.maps import write_map
from momantu_bt.robot import laser_band

WORLD = load_world("four_rooms")
FETCH = fetch()
PLAN, OVERHANG = draw_plans(WORLD, laser_band(FETCH), FETCH.height)


def at(plan, x, y):
    return plan.levels[cells_of(plan, x, y)]


def test_the_picture_is_a_binary_pgm_of_the_size_it_says(tmp_path):
    write_map(tmp_path / "map.yaml", PLAN)
    data = (tmp_path / "map.pgm").read_bytes()
    kind, size, most, pixels = data.split(b"\n", 3)
    assert (kind, most) == (b"P5", b"255")
    columns, rows = (int(n) for n in size.split())
    assert len(pixels) == columns * rows
    assert np.array_equal(np.frombuffer(pixels, np.uint8).reshape(rows, columns), PLAN.levels)


def test_walls_are_occupied_along_their_whole_length():
    for wall in wall_rectangles(WORLD):
        for along in np.linspace(-0.48, 0.48, 40) * wall.size[0]:
            x = wall.pose.x + along * np.cos(wall.pose.yaw)
            y = wall.pose.y + along * np.sin(wall.pose.yaw)
            assert at(PLAN, x, y) == OCCUPIED


def test_walls_are_as_thick_as_they_are():
    # 0.15 m is three cells, or four where the wall lies across their borders
    row, column = cells_of(PLAN, -8.0, 1.737)
    thick = (PLAN.levels[row - 6 : row + 7, column] == OCCUPIED).sum()
    assert thick in (3, 4)


def test_doorways_and_places_are_free():
    for door in WORLD.doorways.values():
        assert at(PLAN, *door.at) == FREE
        assert at(OVERHANG, *door.at) == FREE
    for place in WORLD.site.places.values():
        assert at(PLAN, *place[:2]) == FREE
        assert at(OVERHANG, *place[:2]) == FREE


def test_outside_is_unknown():
    assert PLAN.levels[0, 0] == UNKNOWN
    assert PLAN.levels[-1, -1] == UNKNOWN


@pytest.mark.parametrize("name", ["table_a", "table_b"])
def test_a_table_is_legs_for_the_laser_and_a_top_above(name):
    table = WORLD.tables[name]
    assert at(PLAN, table.at[0], table.at[1]) == FREE
    assert at(OVERHANG, table.at[0], table.at[1]) == OCCUPIED
    reach = 0.5 * max(table.size[:2])
    top, left = cells_of(PLAN, table.at[0] - reach, table.at[1] + reach)
    bottom, right = cells_of(PLAN, table.at[0] + reach, table.at[1] - reach)
    legs = (PLAN.levels[top : bottom + 1, left : right + 1] == OCCUPIED).sum()
    covered = (OVERHANG.levels[top : bottom + 1, left : right + 1] == OCCUPIED).sum()
    assert 0 < legs < 0.25 * covered


def test_the_layers_never_hold_the_same_cell():
    assert not ((PLAN.levels == OCCUPIED) & (OVERHANG.levels == OCCUPIED)).any()


def test_furniture_that_is_closed_to_the_floor_is_on_the_map():
    for name in ("sofa_south_west", "cabinet_corridor", "crate_corridor"):
        x, y, _ = WORLD.furniture[name].at
        assert at(PLAN, x, y) == OCCUPIED

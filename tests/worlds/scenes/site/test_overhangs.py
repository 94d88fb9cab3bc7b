"""What hangs over surfaces is told with them, where the world file has it."""

import pytest
from momantu_worlds.scenes.loading import load_world, nominal, nominal_site
from momantu_worlds.scenes.site.cache import cached_nominal
from momantu_worlds.scenes.site.site import LEAST, MOST

from momantu_bt.geometry import Pose2D

ROOM = {"hall": {"corner": [0, 0], "size": [6, 5]}}


def rack(*boards, at=(4.0, 3.0, 0.4), kind="rack"):
    return {"kind": kind, "at": list(at), "size": [0.6, 2.0, 2.2], "boards": list(boards)}


def board(number):
    return {"board_of": "rack", "board": number, "sides": [0]}


def over(path, name):
    return nominal_site(load_world(path)).surfaces[name].over


@pytest.mark.parametrize("kind", ["rack", "shelf"])
def test_the_boards_above_a_board_are_told_the_lowest_first(write, kind):
    furniture = {"rack": rack(0.1, 0.6, 1.1, 1.6, kind=kind)}
    path = write(rooms=ROOM, furniture=furniture, tables={"top": board(2)})
    surface = nominal_site(load_world(path)).surfaces["top"]
    assert [round(one.top, 6) for one in surface.over] == [1.1, 1.6]
    for one in surface.over:
        assert one.top - one.bottom == pytest.approx(0.03)
        assert one.size == pytest.approx(surface.size)
        off = surface.map_from_surface.inverse() @ one.map_from_overhang
        assert (off.x, off.y, off.yaw) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


def test_a_board_that_is_a_surface_itself_is_not_told_twice(write):
    furniture = {"rack": rack(0.1, 0.6, 1.1, 1.6)}
    path = write(rooms=ROOM, furniture=furniture, tables={"low": board(2), "high": board(3)})
    assert [round(one.top, 6) for one in over(path, "low")] == [1.6]
    assert [round(one.top, 6) for one in over(path, "high")] == [1.6]


def test_under_the_open_sky_nothing_hangs(write):
    table = {"kind": "table", "at": [2, 2, 0], "size": [0.8, 1.2, 0.7], "sides": [0]}
    path = write(rooms=ROOM, furniture={"rack": rack(0.1, 0.6)}, tables={"t": table, "b": board(2)})
    assert over(path, "t") == ()
    assert over(path, "b") == ()


@pytest.mark.parametrize("turn", [0.0, 1.1])
@pytest.mark.parametrize(
    ("x", "rise", "hangs"),
    [
        (0.0, 0.5, True),
        (0.5, 0.5, True),  # over the edge
        (0.6, 0.5, False),  # beside it
        (0.0, LEAST + 0.01, True),
        (0.0, LEAST - 0.01, False),  # it stands there
        (0.0, -0.6, False),  # below
        (0.0, MOST + 0.01, False),
    ],
)
def test_a_cupboard_counts_where_it_hangs_over_the_surface(write, x, rise, hangs, turn):
    """Whatever it belongs to, and however the table is turned."""
    place = Pose2D(2.0, 2.0, turn)
    at = place @ Pose2D(x, 0.3, 0.0)
    table = {"kind": "table", "at": [2.0, 2.0, turn], "size": [0.8, 1.2, 0.7], "sides": [0]}
    part = {"box": [0.3, 0.5, 0.4], "at": [0, 0, 0.2]}
    cupboard = {"category": "cupboard", "at": [at.x, at.y, 0.7 + rise, turn], "parts": [part]}
    path = write(rooms=ROOM, tables={"table": table}, bodies={"cupboard": cupboard})
    found = over(path, "table")
    assert len(found) == hangs
    for one in found:
        assert (one.bottom, one.top) == pytest.approx((0.7 + rise, 1.1 + rise))
        assert one.map_from_overhang.distance_to(at) < 1e-9


def test_what_moves_or_does_not_collide_is_not_told(write):
    table = {"kind": "table", "at": [2, 2, 0], "size": [0.8, 1.2, 0.7], "sides": [0]}
    lamp = {"sphere": 0.1, "at": [0, 0, 0]}
    bodies = {
        "picture": {"at": [2, 2, 1.2, 0], "parts": [{**lamp, "collision": False}]},
        "balloon": {"at": [2, 2, 1.2, 0], "static": False, "mass": 0.1, "parts": [lamp]},
    }
    assert over(write(rooms=ROOM, tables={"table": table}, bodies=bodies), "table") == ()


def test_what_is_kept_of_a_site_keeps_what_hangs(write):
    path = write(rooms=ROOM, furniture={"rack": rack(0.1, 0.6, 1.1)}, tables={"top": board(2)})
    first = nominal(path)
    assert len(first.site.surfaces["top"].over) == 1
    assert cached_nominal(path.read_bytes()) == first

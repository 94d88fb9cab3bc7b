"""Places of an import lie inside the building, in free reachable floor, one in every room."""

import math

import pytest

GROUND = "<include><uri>model://ground_plane</uri></include>"


def walls(box, yaw=0.0):
    """Two rooms side by side, 10 x 6 m, a door of 1.2 m between them and one to the outside."""
    pieces = [
        (0, -3, 10, 0),
        (0, 3, 10, 0),
        (-5, 0, 6, math.pi / 2),
        (5, 1.8, 2.4, math.pi / 2),
        (5, -1.8, 2.4, math.pi / 2),
        (0, -2.1, 1.8, math.pi / 2),
        (0, 1.5, 3.0, math.pi / 2),
    ]
    turned = [
        (x * math.cos(yaw) - y * math.sin(yaw), x * math.sin(yaw) + y * math.cos(yaw), length, turn)
        for x, y, length, turn in pieces
    ]
    return "".join(
        box(f"wall{n}", f"{length} 0.1 2.5", f"{x} {y} 1.25 0 0 {turn + yaw}")
        for n, (x, y, length, turn) in enumerate(turned)
    )


@pytest.mark.parametrize("yaw", [0.0, 0.4])
def test_every_room_has_a_place_that_is_named_by_what_stands_there(imported, box, yaw):
    def at(x, y):
        return (x * math.cos(yaw) - y * math.sin(yaw), x * math.sin(yaw) + y * math.cos(yaw))

    def put(name, size, x, y, z):
        return box(name, size, "{} {} {} 0 0 {}".format(*at(x, y), z, yaw))

    inside = GROUND + walls(box, yaw) + put("desk_01", "0.8 1.4 0.72", -4.4, 0, 0.36)
    inside += put("Bed", "1.4 2 0.5", 4, 1.5, 0.25) + put("lamp", "0.2 0.2 1.2", 1, 2, 0.6)
    inside += put("shed", "2 2 2.5", -3, 9, 1.25)
    site = imported(inside).world.site
    assert sorted(site.places) in (["home", "near_bed"], ["home", "near_desk"])
    own = {}
    for name, pose in site.places.items():
        x, y = (
            at(pose.x, pose.y)
            if not yaw
            else (
                pose.x * math.cos(yaw) + pose.y * math.sin(yaw),
                pose.y * math.cos(yaw) - pose.x * math.sin(yaw),
            )
        )
        assert abs(x) < 4.6, name
        assert abs(y) < 2.6, name
        own[name] = x
    assert {x > 0 for x in own.values()} == {True, False}
    for name in own:
        assert name == "home" or (own[name] > 0) == (name == "near_bed")


def test_without_walls_everything_is_inside(imported, box):
    site = imported(GROUND + box("desk", "0.8 1.4 0.72", "0 0 0.36 0 0 0")).world.site
    assert list(site.places) == ["home"]
    assert 0.7 < math.hypot(site.start.x, site.start.y) < 3


def test_nobody_stands_outside_to_reach_a_table_at_a_wall(imported, box):
    """The floor around a house is one large region, and a table at the wall is near to it."""
    inside = GROUND + walls(box)
    inside += box("desk", "0.5 0.8 0.72", "-4.7 0 0.36 0 0 0")
    inside += box("gate", "0.1 1.4 2.5", "5 0 1.25 0 0 0")
    site = imported(inside).world.site
    assert site.surfaces["desk"].sides[0] == 0.0
    assert all(abs(abs(side) - math.pi) > 0.1 for side in site.surfaces["desk"].sides)
    assert all(abs(pose.x) < 4.6 and abs(pose.y) < 2.6 for pose in site.places.values())

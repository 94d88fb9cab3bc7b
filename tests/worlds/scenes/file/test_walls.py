"""Walls follow from rooms: each stands once, doors cut them, corners are closed."""

import math
from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_worlds.scenes.file.building import Door, Room, Walls
from momantu_worlds.scenes.file.walls import RoomWalls

WALLS = Walls(thickness=0.1, height=2.5)
TWO = {"a": Room(corner=(0, 0), size=(4, 3)), "b": Room(corner=(4, 0), size=(2, 3))}


def runs(rooms, doors=None, walls=WALLS):
    made = RoomWalls(walls, rooms, doors or {})
    assert not made.problems
    return list(made.runs())


def covering(found, x, y, height=1.0):
    """Runs whose middle line passes within a millimetre of a point."""
    near = []
    for run in found:
        dx, dy = x - run.pose.x, y - run.pose.y
        along = dx * math.cos(run.pose.yaw) + dy * math.sin(run.pose.yaw)
        across = dy * math.cos(run.pose.yaw) - dx * math.sin(run.pose.yaw)
        inside = abs(along) <= run.length / 2 and abs(across) <= 0.001
        if inside and run.bottom <= height <= run.top:
            near.append(run)
    return near


@st.composite
def plans(draw):
    """Rooms in a grid of random columns and rows, some of which are missing."""
    xs = np.cumsum([0.0, *draw(st.lists(st.integers(2, 6), min_size=1, max_size=4))])
    ys = np.cumsum([0.0, *draw(st.lists(st.integers(2, 6), min_size=1, max_size=3))])
    cells = [(i, j) for i in range(len(xs) - 1) for j in range(len(ys) - 1)]
    chosen = draw(st.lists(st.sampled_from(cells), min_size=1, unique=True))
    return {
        f"room_{i}_{j}": Room(corner=(xs[i], ys[j]), size=(xs[i + 1] - xs[i], ys[j + 1] - ys[j]))
        for i, j in chosen
    }


@given(plans(), st.floats(0.05, 0.95))
def test_every_edge_of_a_room_has_one_wall(rooms, share):
    found = runs(rooms)
    for room in rooms.values():
        for (ax, ay), (bx, by) in pairwise((*room.corners, room.corners[0])):
            x, y = ax + share * (bx - ax), ay + share * (by - ay)
            along = [run for run in covering(found, x, y) if _parallel(run, bx - ax, by - ay)]
            assert len(along) == 1


@given(plans())
def test_walls_of_one_line_do_not_overlap_and_names_differ(rooms):
    found = runs(rooms)
    assert len({run.name for run in found}) == len(found)
    for a, b in combinations(found, 2):
        dx, dy = b.pose.x - a.pose.x, b.pose.y - a.pose.y
        across = dy * math.cos(a.pose.yaw) - dx * math.sin(a.pose.yaw)
        if _parallel(a, math.cos(b.pose.yaw), math.sin(b.pose.yaw)) and abs(across) < 0.001:
            # ends reach half a thickness into the corners
            assert math.hypot(dx, dy) >= (a.length + b.length) / 2 - WALLS.thickness - 1e-9


def _parallel(run, dx, dy):
    return abs(math.sin(run.pose.yaw - math.atan2(dy, dx))) < 1e-6


def test_an_open_door_is_a_gap_with_a_wall_above_and_a_doorway():
    door = Door(at=(4.02, 1.5), width=0.8)
    made = RoomWalls(WALLS, TWO, {"door": door})
    found = list(made.runs())
    assert covering(found, 4, 1.05)
    assert covering(found, 4, 1.95)
    assert not covering(found, 4, 1.15)
    assert not covering(found, 4, 1.85)
    assert covering(found, 4, 1.5, height=2.2)
    assert made.doorways()["door"].at == pytest.approx((4.0, 1.5))
    assert list(made.leaves()) == []


def test_a_closed_door_is_a_leaf_and_no_doorway():
    made = RoomWalls(WALLS, TWO, {"door": Door(at=(4, 1.5), closed=True)})
    assert [(name, round(pose.x, 6)) for name, _, pose in made.leaves()] == [("door", 4.0)]
    assert made.doorways() == {}


def test_a_door_as_high_as_the_wall_has_nothing_above():
    found = runs(TWO, {"door": Door(at=(4, 1.5), height=2.5)})
    assert all(run.bottom == 0 for run in found)


def test_corners_are_closed():
    found = runs({"a": TWO["a"]})
    half = WALLS.thickness / 2
    for x, y in TWO["a"].corners:
        for dx, dy in ((half, half), (half, -half), (-half, half), (-half, -half)):
            point = np.array([x + 0.99 * dx, y + 0.99 * dy])
            assert any(float(run.base.distance(point)) == 0 for run in found)


def test_a_room_may_have_any_outline():
    triangle = {"a": Room(outline=((0, 0), (3, 0), (0, 3)))}
    found = runs(triangle)
    assert len(found) == 3
    assert covering(found, 1.5, 1.5)


@pytest.mark.parametrize(
    ("door", "words"),
    [
        (Door(at=(2, 1.5)), "no wall of a room is there"),
        (Door(at=(4, 0.2)), "does not fit: its wall ends 0.20 m"),
        (Door(at=(4, 1.5), height=2.6), "the walls are 2.5 m"),
        (Door(at=(40, 1.5)), "no wall of a room is there"),
    ],
)
def test_a_door_that_cannot_be_is_told(door, words):
    assert words in RoomWalls(WALLS, TWO, {"door": door}).problems["door"]


def test_doors_do_not_overlap():
    doors = {"one": Door(at=(4, 1.2)), "two": Door(at=(4, 1.8))}
    assert "overlaps with the door 'one'" in RoomWalls(WALLS, TWO, doors).problems["two"]


@pytest.mark.parametrize(
    "wrong",
    [
        {},
        {"corner": (0, 0)},
        {"size": (1, 1)},
        {"corner": (0, 0), "size": (1, 1), "outline": ((0, 0), (1, 0), (0, 1))},
        {"outline": ((0, 0), (1, 0))},
    ],
)
def test_a_room_is_told_in_one_way(wrong):
    with pytest.raises(ValueError, match=r"corner and size|at least 3"):
        Room(**wrong)

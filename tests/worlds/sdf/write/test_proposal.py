"""Laws of what an import proposes and makes smaller, for things of any size at any place."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_worlds.sdf.body.bodies import ImportedBody
from momantu_worlds.sdf.body.level_tops import (
    HEADROOM,
    HIGHEST,
    LOWEST,
    NARROWEST,
    SMALLEST,
    Around,
    best_top,
)
from momantu_worlds.sdf.body.parts import Part
from momantu_worlds.sdf.body.settling import FLAT, settled
from momantu_worlds.sdf.deviations import Deviations
from momantu_worlds.sdf.mesh.files import Piece
from momantu_worlds.sdf.mesh.reducing import clustered, count, reduced
from momantu_worlds.sdf.read.model import Box
from momantu_worlds.sdf.write.free_floor import HALF_WIDTH, free_floor
from momantu_worlds.sdf.write.proposal import propose

from momantu_bt.formats.places import Place
from momantu_bt.geometry import Array, Transform

CORNERS = np.array(list(product((-0.5, 0.5), repeat=3)))


def block(
    size: tuple[float, float, float],
    at: tuple[float, float, float],
    yaw: float = 0.0,
    *,
    still: bool = True,
    visual: bool = True,
) -> ImportedBody:
    """A box of which the middle lies at a point, m."""
    part = Part(Box(size), Transform(), visual=visual, hulls=(CORNERS * size,))
    place = Transform.from_rpy(at, (0.0, 0.0, yaw))
    return ImportedBody("b", "b", Place("w.sdf"), place, (part,), still)


def hulls(*bodies: ImportedBody) -> list[Array]:
    return [hull for body in bodies for hull in body.hulls()]


LENGTH = st.floats(0.1, 3.0)


@given(LENGTH, LENGTH, st.floats(0.05, 1.6), st.floats(-50, 50), st.floats(-math.pi, math.pi))
@settings(max_examples=60)
def test_a_box_is_a_table_by_its_height_and_size(
    long: float, wide: float, height: float, x: float, yaw: float
) -> None:
    table = block((long, wide, height), (x, -x / 2, height / 2), yaw)
    top = best_top(table, Around(hulls(table)))
    fits = min(long, wide) >= NARROWEST and long * wide >= SMALLEST and LOWEST <= height <= HIGHEST
    near = min(abs(min(long, wide) - NARROWEST), abs(long * wide - SMALLEST)) < 1e-4
    near = near or min(abs(height - LOWEST), abs(height - HIGHEST)) < 1e-4
    assert near or (top is not None) == fits
    if top is not None:
        assert top.height == pytest.approx(height, abs=1e-4)
        assert (top.pose.x, top.pose.y) == pytest.approx((x, -x / 2), abs=1e-3)
        assert sorted(top.size) == pytest.approx(sorted((long, wide)), abs=1e-3)
        assert abs(top.pose.yaw) <= math.pi / 4 + 1e-6
        # along its own x it is as long as the box is in that direction
        turned = abs(math.remainder(top.pose.yaw - yaw, math.pi))
        if abs(long - wide) > 0.01:
            along = long if turned < 0.1 else wide
            assert top.size[0] == pytest.approx(along, abs=1e-2)


@given(st.floats(-0.2, 0.6), st.floats(-math.pi, math.pi))
@settings(max_examples=30)
def test_a_top_needs_free_height_above_its_middle(room: float, yaw: float) -> None:
    table = block((1.0, 0.8, 0.7), (3.0, 2.0, 0.35), yaw)
    shelf = block((1.0, 0.8, 0.02), (3.0, 2.0, 0.7 + room + 0.01), yaw)
    if min(abs(room - HEADROOM), abs(room + 0.02)) > 1e-2:
        free = best_top(table, Around(hulls(table, shelf))) is not None
        assert free == (room > HEADROOM or room < -0.02)
    beside = block((0.1, 0.1, 2.0), (3.0 + 0.49 * math.cos(yaw), 2.0 + 0.49 * math.sin(yaw), 1.0))
    assert best_top(table, Around(hulls(table, beside))) is not None


@given(st.floats(0.3, 2.0), st.floats(-30, 30), st.floats(-math.pi, math.pi))
@settings(max_examples=25)
def test_clearance_is_the_distance_to_what_stands_there(size: float, x: float, yaw: float) -> None:
    thing = block((size, size, 1.0), (x, -x, 0.5), yaw)
    floor = free_floor(hulls(thing))
    for away in (0.2, 0.6, 1.2):
        reach = size / 2 + away
        at = (x + reach * math.cos(yaw), -x + reach * math.sin(yaw))
        index = floor.index(*at)
        assert index is not None
        assert float(floor.clearance[index]) == pytest.approx(away, abs=2.5 * floor.cell)
        assert bool(floor.region(*at)) == (away > HALF_WIDTH)
    assert floor.region(x, -x) == 0
    assert floor.index(x + 1e3, 0.0) is None
    assert floor.region(x + 1e3, 0.0) == 0


def test_only_what_is_in_a_robots_way_takes_floor() -> None:
    wall = block((0.1, 6.0, 2.0), (0.0, 0.0, 1.0))
    for other, blocks in (
        (block((4.0, 4.0, 0.02), (2.0, 0.0, 0.01)), False),  # a carpet
        (block((4.0, 4.0, 0.1), (2.0, 0.0, -0.02 + 1e-9)), False),  # a floor
        (block((4.0, 4.0, 0.2), (2.0, 0.0, 2.2)), False),  # a ceiling
        (block((4.0, 4.0, 0.2), (2.0, 0.0, 1.0)), True),
    ):
        assert (free_floor(hulls(wall, other)).region(2.0, 0.0) == 0) == blocks


def test_a_wall_through_a_room_makes_two_regions() -> None:
    around = [block((0.1, 6.0, 2.0), (x, 0.0, 1.0)) for x in (-3.0, 0.0, 3.0)]
    around += [block((6.0, 0.1, 2.0), (0.0, y, 1.0)) for y in (-3.0, 3.0)]
    floor = free_floor(hulls(*around))
    left, right, outside = (floor.region(x, 0.0) for x in (-1.5, 1.5, 4.5))
    assert len({left, right, outside, 0}) == 4
    assert floor.area(left) == pytest.approx((3.0 - 0.1 - 2 * HALF_WIDTH) * (5.9 - 0.7), rel=0.15)
    points = floor.points(floor.regions == left)
    assert (np.abs(points - (-1.5, 0.0)) < (1.5, 3.0)).all()


@given(st.floats(-2, 2), st.floats(0.005, 0.08), st.booleans())
@settings(max_examples=40)
def test_what_lies_flat_is_not_touched_and_all_is_lowered_to_the_floor(
    floor: float, thick: float, visual: bool
) -> None:
    slab = block((1.0, 1.0, thick), (4.0, 1.0, floor + thick / 2), 0.3, visual=visual)
    loose = block((1.0, 1.0, thick), (4.0, 1.0, floor + thick / 2), still=False)
    deviations = Deviations()
    found = list(settled([slab, loose], floor, deviations))
    flat = thick <= FLAT
    if abs(thick - FLAT) < 1e-6:
        return
    assert len(found) == (1 if flat and not visual else 2)
    for body in found:
        assert body.at.position[2] == pytest.approx(thick / 2, abs=1e-9)
        assert body.at.position[:2] == pytest.approx((4.0, 1.0))
        (part,) = body.parts
        assert part.collision == (not (flat and body.still))
    assert [deviation.outcome.value for deviation in deviations] == (
        [] if not flat else ["changed" if visual else "dropped"]
    )


def lattice(count_: int, seed: int) -> Piece:
    """A bumpy sheet of 2 * (count_ - 1)^2 triangles, with its uv where its points are."""
    ticks = np.linspace(0.0, 1.0, count_)
    x, y = (values.ravel() for values in np.meshgrid(ticks, ticks))
    z = 0.02 * np.random.default_rng(seed).random(x.size)
    corner = np.arange(count_ * count_).reshape(count_, count_)
    a, b, c, d = (
        corner[i : count_ - 1 + i, j : count_ - 1 + j] for i, j in product((0, 1), (0, 1))
    )
    triangles = np.concatenate(
        [np.stack([a, b, c], -1).reshape(-1, 3), np.stack([b, d, c], -1).reshape(-1, 3)]
    )
    return Piece(np.column_stack([x, y, z]), triangles, uv=np.column_stack([x, y]))


@given(st.integers(5, 40), st.integers(20, 2000), st.integers(0, 99))
@settings(max_examples=40)
def test_a_mesh_gets_small_enough_and_stays_where_it_was(size: int, most: int, seed: int) -> None:
    sheet = lattice(size, seed)
    found = reduced([sheet], most)
    assert count(found) <= most
    if count([sheet]) <= most:
        assert found == (sheet,)
        return
    assert count(found) > most / 20
    (piece,) = found
    known = {tuple(vertex) for vertex in sheet.vertices}
    assert {tuple(vertex) for vertex in piece.vertices} <= known
    assert piece.uv == pytest.approx(piece.vertices[:, :2])
    assert piece.triangles.max() < len(piece.vertices)
    span = np.ptp(piece.vertices[:, :2], axis=0)
    assert most < 200 or (span > 0.7).all()


@given(st.floats(0.01, 0.5), st.integers(0, 99))
@settings(max_examples=25)
def test_no_two_vertices_of_a_cell_are_left_and_no_triangle_without_area(
    cell: float, seed: int
) -> None:
    sheet = lattice(20, seed)
    piece = clustered(sheet, cell)
    keys = np.floor((piece.vertices - sheet.vertices.min(axis=0)) / cell)
    assert len(np.unique(keys, axis=0)) == len(piece.vertices)
    rows = np.sort(piece.triangles, axis=1)
    assert (np.diff(rows, axis=1) > 0).all()
    assert len(np.unique(rows, axis=0)) == len(rows)


def test_an_arena_of_low_walls_is_within_although_its_corners_are_high() -> None:
    """Towers at its corners are hollow meshes, higher than walls, and enclose no more than that."""
    fence = [
        block((6.0, 0.2, 0.5), (0.0, 3.0, 0.25)),
        block((6.0, 0.2, 0.5), (0.0, -3.0, 0.25)),
        block((0.2, 6.0, 0.5), (3.0, 0.0, 0.25)),
        block((0.2, 6.0, 0.5), (-3.0, 0.0, 0.25)),
    ]
    tower = [block((1.6, 0.05, 1.6), (3.8, y, 0.8)) for y in (-0.8, 0.8)] + [
        block((0.05, 1.6, 1.6), (x, 0.0, 0.8)) for x in (3.0, 4.6)
    ]
    floor = free_floor(hulls(*fence, *tower))
    assert floor.inside[floor.index(-1.0, 1.0) or (0, 0)]
    assert not floor.inside[floor.index(-4.0, 0.0) or (0, 0)]
    home = propose([*fence, *tower], None).start
    assert abs(home.x) < 3.0
    assert abs(home.y) < 3.0


def test_walls_count_before_what_is_low_where_they_enclose_the_floor() -> None:
    house = [
        block((6.0, 0.2, 2.5), (0.0, 3.0, 1.25)),
        block((6.0, 0.2, 2.5), (0.0, -3.0, 1.25)),
        block((0.2, 6.0, 2.5), (3.0, 0.0, 1.25)),
        block((0.2, 6.0, 2.5), (-3.0, 0.0, 1.25)),
    ]
    garden = [block((0.2, 6.0, 0.5), (6.0, 0.0, 0.25))]
    floor = free_floor(hulls(*house, *garden))
    assert floor.inside[floor.index(0.0, 0.0) or (0, 0)]
    assert not floor.inside[floor.index(4.5, 0.0) or (0, 0)]

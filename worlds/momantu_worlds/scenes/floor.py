"""What stands on the floor of an episode: tables, furniture, the robot's start.

Every choice is drawn from the seed and kept only when the robot can still do its work: doorways
and the tables' preferred sides stay free, and a disc of the world's `passage` radius still gets
from the start to both tables and through every doorway.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from momantu_bt.geometry import Pose2D
from momantu_bt.world import WorldError, seeded
from momantu_worlds.scenes.layout import PlacedPiece, PlacedTable
from momantu_worlds.scenes.plane_geometry import Rectangle, clear_of, passages
from momantu_worlds.scenes.world_file import Piece, Table, WorldFile

TRIES = 60
"""Draws for one thing before it is left out (an extra) or stays where the map has it."""
MOVED_GAP = 0.03
"""m; what a moved piece keeps from everything else."""
EXTRA_GAP = 0.15
"""m; what an extra piece keeps from everything else."""
START_CLEAR = 0.55
"""m; around the start: the robot turns on the spot within 0.35 m, and must see a way out."""
STAND_OFF = 0.55
"""m; from a table's edge to where a robot stands that reaches onto it."""
WIDE = 0.4
"""m; radius of a disc for which a coarse grid is fine enough: its doors are wide."""
COARSE, FINE = 0.1, 0.05
"""m; cells in which passages are looked for. A narrow door leaves a disc's centre a few cm."""
SIDEWAYS = 0.3
"""m; how much wider than the table's side the zone before it is kept free, on either hand."""


def place_tables(world: WorldFile, seed: int) -> dict[str, PlacedTable]:
    """Tables shifted, turned and lifted."""
    placed = {}
    for name, table in world.tables.items():
        draw = seeded(seed, "table", name)
        x, y = draw.uniform(-table.shift, table.shift, 2)
        turn = float(draw.uniform(-table.turn, table.turn))
        lift = float(draw.uniform(-table.lift, table.lift))
        pose = Pose2D(table.pose.x + float(x), table.pose.y + float(y), table.pose.yaw + turn)
        placed[name] = PlacedTable(pose, table.size[2] + lift, table.size[:2])
    return placed


def place_start(world: WorldFile, seed: int) -> tuple[Pose2D, Pose2D]:
    """Where the robot truly stands, and what it is told."""
    draw = seeded(seed, "start")
    nominal = Pose2D(*world.start.at)
    fixed = [*wall_rectangles(world), *(footprint(p, p.pose) for p in world.furniture.values())]
    fixed += [Rectangle(t.pose, t.size[:2]) for t in world.tables.values()]
    for _ in range(TRIES):
        x, y = draw.uniform(-world.start.shift, world.start.shift, 2)
        start = Pose2D(
            nominal.x + float(x), nominal.y + float(y), float(draw.uniform(-math.pi, math.pi))
        )
        if clear_of(around(start, START_CLEAR), fixed, 0.0):
            break
    else:
        raise WorldError(f"no free place to start within {world.start.shift} m of {nominal}")
    away = float(draw.uniform(0.0, world.start.belief_shift))
    where = float(draw.uniform(-math.pi, math.pi))
    turn = float(draw.uniform(-world.start.belief_turn, world.start.belief_turn))
    x, y = start.x + away * math.cos(where), start.y + away * math.sin(where)
    return start, Pose2D(x, y, start.yaw + turn)


def place_furniture(
    world: WorldFile, seed: int, tables: Mapping[str, PlacedTable], start: Pose2D
) -> tuple[PlacedPiece, ...]:
    """Known furniture, some of it moved, and extra pieces.

    Raises:
        WorldError: even with nothing moved and nothing extra the robot could not do its work.
    """
    known = {name: PlacedPiece(name, p, p.pose, True) for name, p in world.furniture.items()}
    placed = dict(known)
    for change in (*_moves(world, seed), *_extras(world, seed)):
        for piece in change:
            others = [footprint(p.piece, p.pose) for n, p in placed.items() if n != piece.name]
            then = {**placed, piece.name: piece}
            if _fits(world, piece, others, tables, start) and _passable(
                world, then.values(), tables, start
            ):
                placed = then
                break
    if placed == known and not _passable(world, known.values(), tables, start):
        raise WorldError(
            f"in the world {world.name!r} a disc of {world.unknown.passage} m does not get from "
            "the start to both tables and through every doorway; move the furniture apart"
        )
    return tuple(placed.values())


def _moves(world: WorldFile, seed: int) -> Iterator[Iterator[PlacedPiece]]:
    draw = seeded(seed, "moved")
    names = [name for name, piece in world.furniture.items() if piece.moves]
    wanted = int(draw.integers(world.unknown.moved.least, world.unknown.moved.most + 1))
    for name in draw.permutation(names)[:wanted].tolist():
        yield _elsewhere(world, seed, name)


def _elsewhere(world: WorldFile, seed: int, name: str) -> Iterator[PlacedPiece]:
    draw, unknown = seeded(seed, "moved", name), world.unknown
    piece = world.furniture[name]
    for _ in range(TRIES):
        x, y = draw.uniform(-unknown.shift, unknown.shift, 2)
        turn = float(draw.uniform(-unknown.turn, unknown.turn))
        pose = Pose2D(piece.pose.x + float(x), piece.pose.y + float(y), piece.pose.yaw + turn)
        yield PlacedPiece(name, piece, pose, True)


def _extras(world: WorldFile, seed: int) -> Iterator[Iterator[PlacedPiece]]:
    unknown = world.unknown
    wanted = int(seeded(seed, "extra").integers(unknown.extra.least, unknown.extra.most + 1))
    for i in range(wanted if unknown.areas else 0):
        yield _anywhere(world, seed, i)


def _anywhere(world: WorldFile, seed: int, number: int) -> Iterator[PlacedPiece]:
    draw, unknown = seeded(seed, "extra", number), world.unknown
    kind = unknown.kinds[int(draw.integers(len(unknown.kinds)))]
    for _ in range(TRIES):
        x0, y0, x1, y1 = unknown.areas[int(draw.integers(len(unknown.areas)))]
        x, y = float(draw.uniform(x0, x1)), float(draw.uniform(y0, y1))
        pose = Pose2D(x, y, float(draw.uniform(-math.pi, math.pi)))
        piece = Piece(kind=kind, at=(pose.x, pose.y, pose.yaw))
        yield PlacedPiece(f"extra_{kind}_{number}", piece, pose, False)


def _fits(
    world: WorldFile,
    placed: PlacedPiece,
    others: list[Rectangle],
    tables: Mapping[str, PlacedTable],
    start: Pose2D,
) -> bool:
    own = footprint(placed.piece, placed.pose)
    least = MOVED_GAP if placed.known else EXTRA_GAP
    doors = [(np.array(door.at), door.clear) for door in world.doorways.values()]
    zones = [around(start, START_CLEAR)]
    zones += [stand_zone(world.tables[n], t, world.unknown.stand) for n, t in tables.items()]
    return (
        clear_of(own, zones, 0.0 if placed.known else EXTRA_GAP)
        and all(float(own.distance(at)) >= radius for at, radius in doors)
        and clear_of(own, wall_rectangles(world), least)
        and clear_of(own, (Rectangle(t.pose, t.size) for t in tables.values()), least)
        and clear_of(own, others, least)
    )


def _passable(
    world: WorldFile,
    pieces: Iterable[PlacedPiece],
    tables: Mapping[str, PlacedTable],
    start: Pose2D,
) -> bool:
    obstacles = [*wall_rectangles(world), *(footprint(p.piece, p.pose) for p in pieces)]
    obstacles += [Rectangle(table.pose, table.size) for table in tables.values()]
    unknown = world.unknown
    cell = COARSE if unknown.passage >= WIDE else FINE
    grid = passages(obstacles, world.floor.center, world.floor.size, unknown.passage, cell)
    stops = [(start.x, start.y), *(door.at for door in world.doorways.values())]
    for name, table in tables.items():
        at = stand_pose(world.tables[name], table)
        stops.append((at.x, at.y))
    return grid.connects(stops)


def footprint(piece: Piece, pose: Pose2D) -> Rectangle:
    """The floor that a piece takes up."""
    return Rectangle(pose, piece.extent[:2])


def around(pose: Pose2D, radius: float) -> Rectangle:
    """A square around a pose, of half edge `radius` m."""
    return Rectangle(pose, (2 * radius, 2 * radius))


def wall_rectangles(world: WorldFile) -> list[Rectangle]:
    """The floor that the walls take up."""
    walls = world.walls
    return [
        Rectangle(walls.map_from_piece(piece), (piece.length, walls.thickness))
        for piece in walls.pieces
    ]


def side_pose(table: Table, placed: PlacedTable, side: int, away: float) -> Pose2D:
    """A pose `away` m before the middle of a side's edge, facing the table."""
    angle = table.sides[side]
    half_x, half_y = placed.size[0] / 2, placed.size[1] / 2
    along = half_x if abs(math.cos(angle)) > abs(math.sin(angle)) else half_y
    reach = along + away
    own = Pose2D(reach * math.cos(angle), reach * math.sin(angle), angle + math.pi)
    return placed.pose @ own


def stand_pose(table: Table, placed: PlacedTable) -> Pose2D:
    """Where a robot stands before the middle of the preferred side."""
    return side_pose(table, placed, 0, STAND_OFF)


def stand_zone(table: Table, placed: PlacedTable, depth: float) -> Rectangle:
    """The floor before the preferred side that is kept free."""
    along_x = abs(math.cos(table.sides[0])) > abs(math.sin(table.sides[0]))
    width = placed.size[1] if along_x else placed.size[0]
    return Rectangle(side_pose(table, placed, 0, depth / 2), (depth, width + 2 * SIDEWAYS))

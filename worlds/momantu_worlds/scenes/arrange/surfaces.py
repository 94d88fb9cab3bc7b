"""Surfaces of a world: tops of tables, boards of shelves and tops of bodies, by their names."""

from __future__ import annotations

import math

from momantu_bt.geometry import Pose2D
from momantu_worlds.scenes.arrange.layout import PlacedTable
from momantu_worlds.scenes.catalogue.shelves import board
from momantu_worlds.scenes.file.furniture import Piece, Table
from momantu_worlds.scenes.file.world import WorldFile
from momantu_worlds.scenes.geometry.bodies import Box, Part


def nominal_surfaces(world: WorldFile) -> dict[str, PlacedTable]:
    """Every surface at its pose in the file: tables and boards first, then tops of bodies."""
    found = {name: _nominal(world, table) for name, table in world.tables.items()}
    for name, body in world.bodies.items():
        if body.surface is not None:
            top = body.surface
            found[name] = PlacedTable(
                Pose2D(*top.at), top.height, top.size, top.sides, round=top.round
            )
    return found


def _nominal(world: WorldFile, table: Table) -> PlacedTable:
    if table.board_of is not None:
        shelf = world.furniture[table.board_of]
        return board_surface(shelf, table, shelf.pose)
    assert table.at is not None
    assert table.size is not None
    flat = table.size[:2]
    return PlacedTable(Pose2D(*table.at), table.size[2], flat, table.sides, round=table.round)


def board_surface(shelf: Piece, table: Table, pose: Pose2D) -> PlacedTable:
    """The top of a shelf's board, with the shelf at `pose`."""
    assert table.board is not None
    index = table.board - 1
    part = board_part(shelf, index)
    box = part.geometry
    assert isinstance(box, Box)
    higher = [height - box.size[2] for height in shelf.boards[index + 1 :]]
    above = higher[0] - shelf.boards[index] if higher else math.inf
    map_from_top = pose @ Pose2D.from_transform(part.body_from_part)
    return PlacedTable(map_from_top, shelf.boards[index], box.size[:2], table.sides, above)


def board_part(shelf: Piece, index: int) -> Part:
    """A board of a shelf, in the shelf's frame."""
    return board(str(shelf.kind), shelf.extent, shelf.boards[index], shelf.color)


def carriers(world: WorldFile) -> dict[str, tuple[str, ...]]:
    """Shelves with boards that are surfaces, and the names of these surfaces."""
    found: dict[str, tuple[str, ...]] = {}
    for name, table in world.tables.items():
        if table.board_of is not None:
            found[table.board_of] = (*found.get(table.board_of, ()), name)
    return found

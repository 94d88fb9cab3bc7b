"""The site's map: a floor plan of the world file in map_server's format.

Two pictures of equal size. `map` holds what meets the plane of the laser: walls and known
furniture where the file has them. `overhang` holds what the laser cannot see of the same furniture
below the robot's height: table tops, seats, low boards.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from momantu_bt.formats.maps import MapPicture
from momantu_bt.geometry import Array, Pose2D
from momantu_bt.world import WorldError
from momantu_worlds.scenes.arrange.episode import piece_parts, table_parts
from momantu_worlds.scenes.arrange.given_bodies import given_bodies
from momantu_worlds.scenes.arrange.obstacles import DOORSTEP, floor_extent, wall_rectangles
from momantu_worlds.scenes.file.world import WorldFile
from momantu_worlds.scenes.geometry.plane import in_outline
from momantu_worlds.scenes.site.coverage import Column, columns_of, covered

OCCUPIED, UNKNOWN, FREE = 0, 205, 254
"""Grey levels; map_server reads a level g as occupied with probability (255 - g) / 255."""
MARGIN = 0.5
"""m; of unknown floor drawn around the outer walls."""
MOST_CELLS = 25_000_000


def draw_plans(
    world: WorldFile, band: tuple[float, float], robot_height: float
) -> tuple[MapPicture, MapPicture]:
    """The map and the overhang layer of a world.

    band: heights above the floor that the laser sees, m; both are equal for a plane. robot_height:
    what is higher does not block the robot, m.

    Raises:
        WorldError: the plan would be too large, or a mesh file cannot be read.
    """
    cell = world.site.resolution
    standing = list(known_parts(world))
    low, high = _extent(world, cell)
    columns, rows = (round(float(extent) / cell) for extent in high - low)
    if columns * rows > MOST_CELLS:
        raise WorldError(
            f"the map of {world.name!r} would have {columns} x {rows} cells of {cell:g} m; at most "
            f"{MOST_CELLS}: make site.resolution coarser"
        )
    centers = np.stack(
        np.meshgrid(
            low[0] + cell * (np.arange(columns) + 0.5), low[1] + cell * (np.arange(rows) + 0.5)
        ),
        axis=-1,
    )
    walls = [Column(base, 0.0, math.inf) for base in wall_rectangles(world)]
    solid = covered(centers, [*walls, *standing], cell, band)
    hanging = covered(centers, standing, cell, (DOORSTEP, robot_height)) & ~solid
    plan = np.where(solid, OCCUPIED, np.where(_inside(world, centers), FREE, UNKNOWN))
    origin = _short(round(float(low[0]), 6)), _short(round(float(low[1]), 6))
    resolution = _short(cell)
    return (
        MapPicture(np.flipud(plan).astype(np.uint8), resolution, origin),
        MapPicture(
            np.flipud(np.where(hanging, OCCUPIED, FREE)).astype(np.uint8), resolution, origin
        ),
    )


def _short(number: float) -> float:
    """The number with six significant digits, as the map's file has it."""
    return float(f"{number:g}")


def known_parts(world: WorldFile) -> Iterator[Column]:
    """Every colliding part of what stands still and is not a wall, where the file has it."""
    for table in world.tables.values():
        if table.board_of is None and table.at is not None and table.size is not None:
            parts = table_parts(world, table, table.size)
            yield from columns_of(parts, Pose2D(*table.at).transform())
    for piece in world.furniture.values():
        yield from columns_of(piece_parts(world, piece), piece.pose.transform())
    for body in given_bodies(world):
        if body.static:
            yield from columns_of(body.parts, body.map_from_body)
    for run in world.wall_runs:
        if run.bottom > 0.0:
            yield Column(run.base, run.bottom, run.top)


def _extent(world: WorldFile, cell: float) -> tuple[Array, Array]:
    """Lower left and upper right corner of the plan, on whole cells."""
    low, high = _walled(world)
    return np.floor((low - MARGIN) / cell) * cell, np.ceil((high + MARGIN) / cell) * cell


def area_of(world: WorldFile) -> tuple[float, float, float, float]:
    """The least x and y and the largest x and y within the walls, m."""
    low, high = _walled(world)
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def _walled(world: WorldFile) -> tuple[Array, Array]:
    """The box around all walls, or around the floor where there are none."""
    walls = wall_rectangles(world)
    if not walls:
        center, size = (np.array(pair) for pair in floor_extent(world))
        return center - size / 2, center + size / 2
    corners = np.concatenate([wall.corners() for wall in walls])
    return corners.min(axis=0), corners.max(axis=0)


def _inside(world: WorldFile, centers: Array) -> NDArray[np.bool_]:
    """Cells within rooms and doors, or within the box around walls that are given alone."""
    if world.rooms and not world.walls.pieces:
        inside = np.zeros(centers.shape[:2], dtype=np.bool_)
        for room in world.rooms.values():
            inside |= in_outline(centers, np.array(room.corners))
        for threshold in world.room_walls.thresholds():
            inside |= threshold.distance(centers) <= 0.0
        return inside
    low, high = _walled(world)
    return np.asarray(np.all((centers >= low) & (centers <= high), axis=-1))


def cells_of(plan: MapPicture, x: float, y: float) -> tuple[int, int]:
    """(row, column) of the pixel that shows a point of the map."""
    column = math.floor((x - plan.origin[0]) / plan.resolution)
    row = plan.levels.shape[0] - 1 - math.floor((y - plan.origin[1]) / plan.resolution)
    return row, column

"""The site's map: a floor plan of the world file in map_server's format.

Two pictures of equal size. `map` holds what meets the plane of the laser: walls and known
furniture where the file has them. `overhang` holds what the laser cannot see of the same furniture
below the robot's height: table tops, seats, low boards.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Pose2D
from momantu_worlds.scenes.bodies import Box, Cylinder, Part
from momantu_worlds.scenes.floor import wall_rectangles
from momantu_worlds.scenes.furniture import furniture
from momantu_worlds.scenes.plane_geometry import Rectangle
from momantu_worlds.scenes.sites import put
from momantu_worlds.scenes.world_file import WorldFile

OCCUPIED, UNKNOWN, FREE = 0, 205, 254
"""Grey levels; map_server reads a level g as occupied with probability (255 - g) / 255."""
OCCUPIED_ABOVE, FREE_BELOW = 0.65, 0.196
MARGIN = 0.5
"""m; of unknown floor drawn around the outer walls."""
DOORSTEP = 0.03
"""m; a robot drives over what is lower."""


@dataclass(frozen=True, slots=True)
class FloorPlan:
    """A picture of the floor. origin: of its lower left corner in the map, m. Row 0 is the top."""

    pixels: NDArray[np.uint8]
    origin: tuple[float, float]
    resolution: float


@dataclass(frozen=True, slots=True)
class Standing:
    """The floor under one part, and the heights between which it lies, m."""

    base: Rectangle
    bottom: float
    top: float
    round: bool


def draw_plans(world: WorldFile) -> tuple[FloorPlan, FloorPlan]:
    """The map and the overhang layer of a world."""
    cell = world.site.resolution
    walls = wall_rectangles(world)
    corners = np.concatenate([wall.corners() for wall in walls])
    low = np.floor((corners.min(axis=0) - MARGIN) / cell) * cell
    high = np.ceil((corners.max(axis=0) + MARGIN) / cell) * cell
    columns, rows = (round(float(extent) / cell) for extent in high - low)
    centers = np.stack(
        np.meshgrid(
            low[0] + cell * (np.arange(columns) + 0.5), low[1] + cell * (np.arange(rows) + 0.5)
        ),
        axis=-1,
    )
    laser = world.site.laser_height
    standing = list(known_parts(world))
    met = [s for s in standing if s.bottom <= laser <= s.top]
    above = [
        s
        for s in standing
        if not s.bottom <= laser <= s.top
        and s.top > DOORSTEP
        and s.bottom < world.site.robot_height
    ]
    solid = _covered(centers, [*(Standing(w, 0, 0, False) for w in walls), *met], cell)
    hanging = _covered(centers, above, cell) & ~solid
    inside = _inside(centers, walls)
    plan = np.where(solid, OCCUPIED, np.where(inside, FREE, UNKNOWN))
    origin = (round(float(low[0]), 6), round(float(low[1]), 6))
    return (
        FloorPlan(np.flipud(plan).astype(np.uint8), origin, cell),
        FloorPlan(np.flipud(np.where(hanging, OCCUPIED, FREE)).astype(np.uint8), origin, cell),
    )


def known_parts(world: WorldFile) -> Iterator[Standing]:
    """Every colliding part of tables and furniture, where the file has it."""
    for table in world.tables.values():
        yield from _standing(furniture(table.kind, table.size, table.color), table.pose)
    for piece in world.furniture.values():
        yield from _standing(furniture(piece.kind, piece.size, piece.color), piece.pose)


def _standing(parts: Iterable[Part], pose: Pose2D) -> Iterator[Standing]:
    for part in parts:
        shape, at = part.geometry, part.body_from_part
        if not part.collision or not isinstance(shape, Box | Cylinder):
            continue
        round_ = isinstance(shape, Cylinder)
        size = (
            (2 * shape.radius, 2 * shape.radius) if isinstance(shape, Cylinder) else shape.size[:2]
        )
        height = shape.height if isinstance(shape, Cylinder) else shape.size[2]
        middle = float(at.position[2])
        yield Standing(
            Rectangle(pose @ Pose2D.from_transform(at), size),
            middle - height / 2,
            middle + height / 2,
            round_,
        )


def _covered(
    centers: NDArray[np.float64], parts: Iterable[Standing], cell: float
) -> NDArray[np.bool_]:
    """Cells whose centre lies in a part; a part thinner than a cell counts as one cell thick."""
    covered = np.zeros(centers.shape[:2], dtype=np.bool_)
    for part in parts:
        pose, size = part.base.pose, part.base.size
        grown = Rectangle(pose, (max(size[0], cell), max(size[1], cell)))
        if part.round:
            radius = max(size[0], cell) / 2
            offset = centers - (pose.x, pose.y)
            covered |= np.hypot(offset[..., 0], offset[..., 1]) <= radius
        else:
            covered |= grown.distance(centers) <= 1e-9
    return covered


def _inside(centers: NDArray[np.float64], walls: list[Rectangle]) -> NDArray[np.bool_]:
    """Cells within the box around all walls."""
    corners = np.concatenate([wall.corners() for wall in walls])
    low, high = corners.min(axis=0), corners.max(axis=0)
    return np.asarray(np.all((centers >= low) & (centers <= high), axis=-1))


def save_plan(plan: FloorPlan, yaml_file: Path) -> None:
    """Write a plan as map_server's YAML beside a binary PGM of the same name."""
    picture = yaml_file.with_suffix(".pgm")
    rows, columns = plan.pixels.shape
    put(picture, f"P5\n{columns} {rows}\n255\n".encode() + plan.pixels.tobytes())
    text = (
        f"image: {picture.name}\n"
        f"resolution: {plan.resolution:g}\n"
        f"origin: [{plan.origin[0]:g}, {plan.origin[1]:g}, 0]\n"
        "negate: 0\n"
        f"occupied_thresh: {OCCUPIED_ABOVE}\n"
        f"free_thresh: {FREE_BELOW}\n"
    )
    put(yaml_file, text.encode())


def cells_of(plan: FloorPlan, x: float, y: float) -> tuple[int, int]:
    """(row, column) of the pixel that shows a point of the map."""
    column = math.floor((x - plan.origin[0]) / plan.resolution)
    row = plan.pixels.shape[0] - 1 - math.floor((y - plan.origin[1]) / plan.resolution)
    return row, column

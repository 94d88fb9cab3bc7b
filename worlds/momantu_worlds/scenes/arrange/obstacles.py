"""The fixed obstacles of a world file: walls, doors, furniture, bodies, the slab."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from momantu_bt.geometry import Pose2D
from momantu_bt.world import WorldError
from momantu_worlds.scenes.arrange.given_bodies import given_bodies
from momantu_worlds.scenes.arrange.mesh_files import mesh_size
from momantu_worlds.scenes.arrange.surfaces import nominal_surfaces
from momantu_worlds.scenes.file.building import MOST_FLOOR
from momantu_worlds.scenes.file.furniture import Piece
from momantu_worlds.scenes.file.walls import LEAF
from momantu_worlds.scenes.file.world import WorldFile
from momantu_worlds.scenes.geometry.parts import Size3
from momantu_worlds.scenes.geometry.plane import Rectangle
from momantu_worlds.scenes.geometry.prisms import tightest_prism
from momantu_worlds.scenes.geometry.solids import outline

DOORSTEP = 0.03
"""Height below which a robot drives over a part, m."""
HEADROOM = 1.8
"""Height above which a robot drives under a part, m."""
SLAB_MARGIN = 2.0
"""Margin of floor around everything, m, if the file does not give the floor's size."""


def footprint(world: WorldFile, piece: Piece, pose: Pose2D) -> Rectangle:
    """The floor area under a piece."""
    return Rectangle(pose, piece_size(world, piece)[:2])


def piece_size(world: WorldFile, piece: Piece) -> Size3:
    """(depth, width, height) of a piece, m; WorldError when its mesh cannot be read."""
    if piece.mesh is None:
        return piece.extent
    return mesh_size(piece.mesh, world.beside(piece.mesh.file))


def fixed_rectangles(world: WorldFile) -> list[Rectangle]:
    """The floor under walls, closed doors, and static bodies that obstruct the robot."""
    return [*wall_rectangles(world), *(base for base, _, _ in body_columns(world))]


def wall_rectangles(world: WorldFile) -> list[Rectangle]:
    """The floor area under walls and closed doors."""
    return [run.base for run in world.wall_runs if run.bottom <= 0.0] + [
        Rectangle(pose, (door.width, LEAF)) for _, door, pose in world.door_leaves
    ]


def body_columns(world: WorldFile) -> Iterator[tuple[Rectangle, float, float]]:
    """The floor area under each part of the static bodies, and its heights, m.

    Parts that a robot can drive over or under are left out.
    """
    for body in given_bodies(world):
        for part in body.parts if body.static else ():
            if part.collision:
                map_from_part = body.map_from_body @ part.body_from_part
                prism = tightest_prism(map_from_part.apply(outline(part)))
                if prism.top > DOORSTEP and prism.bottom < HEADROOM:
                    yield prism.base, prism.bottom, prism.top


def floor_extent(world: WorldFile) -> tuple[tuple[float, float], tuple[float, float]]:
    """Centre and size of the floor, m: as given, or around all bodies.

    Raises:
        WorldError: it would be wider than MOST_FLOOR.
    """
    floor = world.floor
    if floor.center is not None and floor.size is not None:
        return floor.center, floor.size
    found = [*fixed_rectangles(world), Rectangle(Pose2D(*world.start.at), (1.0, 1.0))]
    found += [footprint(world, piece, piece.pose) for piece in world.furniture.values()]
    found += [Rectangle(top.pose, top.size) for top in nominal_surfaces(world).values()]
    corners = np.concatenate([rectangle.corners() for rectangle in found])
    low, high = corners.min(axis=0) - SLAB_MARGIN, corners.max(axis=0) + SLAB_MARGIN
    (x, y), (width, depth) = ((low + high) / 2).tolist(), (high - low).tolist()
    if max(width, depth) > MOST_FLOOR:
        raise WorldError(
            f"the world {world.name!r} is {max(width, depth):.0f} m wide; at most {MOST_FLOOR:g} m"
        )
    return (x, y), (width, depth)

"""From a floor plan to a world file: what is occupied becomes walls, what is free a floor."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from momantu_bt.errors import InputError
from momantu_bt.formats.maps import FREE, OCCUPIED, MapPicture, read_map
from momantu_bt.formats.places import Place
from momantu_bt.geometry import Array, Transform
from momantu_worlds.floor_plan.rectangles import Rectangle, rectangles, without_specks
from momantu_worlds.sdf.body.bodies import ImportedBody, plain_name
from momantu_worlds.sdf.body.ground import Ground
from momantu_worlds.sdf.body.parts import MeshPart, Part
from momantu_worlds.sdf.deviations import Deviations
from momantu_worlds.sdf.importing import Import
from momantu_worlds.sdf.mesh.assets import MOST_PIECES, Assets
from momantu_worlds.sdf.mesh.files import Piece
from momantu_worlds.sdf.read.model import Box
from momantu_worlds.sdf.write.free_floor import HALF_WIDTH, FreeFloor
from momantu_worlds.sdf.write.proposal import propose_places
from momantu_worlds.sdf.write.writing import Imported, world_text

SPECK = 0.01
"""Least floor area of a thing on the map, m2; smaller ones are taken for noise of a laser."""
FEW = 40
"""Up to so many boxes are written one by one; more become mesh files."""
COLOR = (0.86, 0.85, 0.81)
_CORNERS = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
_FACES = np.array(
    [
        *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)),
        *((2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
    ]
)


def import_floor_plan(file: Path, output: Path, height: float) -> Import:
    """Turn a map of map_server into a world file; nothing is written yet.

    Args:
        file: the map's YAML file.
        output: where the world file will lie; the world refers to the map for its robot.
        height: of the walls, m.

    Raises:
        MapError: the map is missing or broken.
        InputError: no robot fits anywhere on its free floor.
    """
    picture, deviations = read_map(file), Deviations()
    cells = picture.cells()
    least = max(1, round(SPECK / picture.resolution**2))
    occupied, specks = without_specks(cells == OCCUPIED, least)
    if specks:
        what = f"{specks} things under {SPECK * 1e4:.0f} cm2 on the floor"
        deviations.dropped(Place(str(file)), "map", what, "left out as noise")
    assets = Assets(f"{plain_name(output.stem)}_assets")
    bodies = _walls(rectangles(occupied), picture, height, assets, file)
    floor = _free_floor(cells == FREE, picture)
    if not floor.regions.any():
        raise InputError(
            f"{file}: no free floor is {2 * HALF_WIDTH:.1f} m wide, so no robot can stand anywhere",
            hint="Are its thresholds, `negate` and `resolution` right?",
        )
    name = plain_name(output.stem)
    world = Imported(
        name,
        file.name,
        None,
        bodies,
        Ground(),
        None,
        propose_places(floor),
        map=os.path.relpath(file, output.parent),
    )
    return Import(world, world_text(world, deviations), assets, deviations)


def _walls(
    found: Sequence[Rectangle], picture: MapPicture, height: float, assets: Assets, file: Path
) -> list[ImportedBody]:
    """Bodies of boxes, of at most as many as one mesh file may have."""
    boxes = [_box(each, picture, height) for each in found]
    groups = [boxes[at : at + MOST_PIECES] for at in range(0, len(boxes), MOST_PIECES)]
    bodies = []
    for number, group in enumerate(groups, start=1):
        name = "walls" if len(groups) == 1 else f"walls_{number}"
        parts = _boxes(group) if len(boxes) <= FEW else _meshes(name, group, assets)
        place = Place(str(file))
        bodies.append(ImportedBody(name, file.name, place, Transform(), tuple(parts), still=True))
    return bodies


def _box(cells: Rectangle, picture: MapPicture, height: float) -> tuple[Array, Array]:
    """Middle and edges (3,) of a box over cells, in the map, m."""
    low = np.array([cells.column, cells.row]) * picture.resolution + picture.origin
    high = np.array([cells.column_end, cells.row_end]) * picture.resolution + picture.origin
    return np.array([*(low + high) / 2, height / 2]), np.array([*(high - low), height])


def _boxes(boxes: Sequence[tuple[Array, Array]]) -> list[Part]:
    return [
        Part(
            Box((float(e[0]), float(e[1]), float(e[2]))),
            Transform(middle),
            COLOR,
            hulls=(_CORNERS * e,),
        )
        for middle, e in boxes
    ]


def _meshes(name: str, boxes: Sequence[tuple[Array, Array]], assets: Assets) -> list[Part]:
    """One mesh to look at, and one of convex pieces to touch."""
    corners = [middle + _CORNERS * edges for middle, edges in boxes]
    # no face shares a corner with another, so that edges look sharp
    faces = np.concatenate([each[_FACES.ravel()] for each in corners])
    seen = Piece(faces, np.arange(len(faces)).reshape(-1, 3), COLOR)
    look, touch = assets.look(name, [seen], COLOR), assets.touch(name, corners)
    return [
        Part(MeshPart(look), Transform(), COLOR, collision=False),
        Part(MeshPart(touch), Transform(), COLOR, visual=False, hulls=tuple(corners)),
    ]


def _free_floor(free: np.ndarray, picture: MapPicture) -> FreeFloor:
    """Where the map says that the floor is free; beyond its edges nothing is."""
    bordered = np.pad(free, 1).astype(np.uint8)
    away = cv2.distanceTransform(bordered, cv2.DIST_L2, 5)[1:-1, 1:-1] * picture.resolution
    clearance = np.asarray(away, dtype=np.float32)
    fits = (clearance > HALF_WIDTH).astype(np.uint8)
    _, regions = cv2.connectedComponents(fits, connectivity=4)
    walls = ~np.asarray(free, dtype=bool)
    return FreeFloor(
        picture.origin, picture.resolution, clearance, np.asarray(regions), walls, walls
    )

"""Convex pieces as the collision shape of a mesh.

A mesh is split into its connected parts, and each part is replaced by its convex hull. Such a hull
is useless if it fills space for the robot or for objects (a room, the space below a table). Hollow
static parts are split instead: a table into its top and its legs. The faces of a building, and of
what cannot be split so, become thin plates.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial import QhullError

from momantu_bt.geometry import Array
from momantu_worlds.scenes.geometry.hulls import HullMesh, hull_mesh
from momantu_worlds.sdf.mesh.files import Piece
from momantu_worlds.sdf.mesh.hollow import Air, is_building
from momantu_worlds.sdf.mesh.plates import plates_of
from momantu_worlds.sdf.mesh.splitting import split_hulls

SMALL = 0.3
"""Largest extent of parts that are always replaced by their hulls, m: nothing stands inside
them."""
MOST_PARTS = 400
"""Most parts of one mesh; with more, the hull of the whole mesh is used."""
FILLED = 0.7
"""Largest share of a hollow part's hull that its convex pieces may have."""
MOST_PLATES = 60
"""Most plates of a part that is no building: cushions and frames of many faces are hulls."""
FLAT_HULL = 1e-9
"""Volume below which a hull is flat, m3."""
THICKENED = 0.005
"""Thickness that is added to flat parts on every side, m."""

_untyped: Any = trimesh
"""trimesh without types, for what it does not declare."""


def convex_pieces(pieces: Sequence[Piece], *, still: bool) -> tuple[list[Array], bool]:
    """Points (n, 3) of convex pieces that cover a mesh, m; and whether they are plain hulls only.

    still: the body is static, so hollow parts may become plates.
    """
    parts = list(_parts(pieces))
    if len(parts) > MOST_PARTS:
        return [_hull(np.concatenate([v for v, _ in parts])).vertices], True
    found: list[Array] = []
    plain = True
    air = Air(parts) if still else None
    for vertices, triangles in parts:
        hull = _hull(vertices)
        hollow = air is not None and np.ptp(vertices, axis=0).max() > SMALL and air.fills(hull)
        split = _split(vertices, triangles, hull) if hollow else []
        plain = plain and not split
        found += split or [np.asarray(hull.vertices)]
    return found, plain


def _split(vertices: Array, triangles: NDArray[np.int64], hull: HullMesh) -> list[Array]:
    """Convex pieces of a hollow part: a few for furniture, else plates; none when neither fits."""
    if is_building(vertices):
        return plates_of(vertices, triangles)
    pieces = [_hull(piece) for piece in split_hulls(vertices, triangles)]
    split = [piece.vertices for piece in pieces]
    if sum(piece.volume for piece in pieces) < FILLED * hull.volume:
        return split
    plates = plates_of(vertices, triangles)
    few = 0 < len(plates) <= MOST_PLATES
    return plates if few else split if len(split) > 1 else []


def _parts(pieces: Sequence[Piece]) -> Iterator[tuple[Array, NDArray[np.int64]]]:
    """Vertices and triangles of all connected parts, regardless of their materials."""
    offsets = np.cumsum([0, *(len(piece.vertices) for piece in pieces)])
    vertices = np.concatenate([piece.vertices for piece in pieces])
    triangles = np.concatenate([p.triangles + o for p, o in zip(pieces, offsets, strict=False)])
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    mesh.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=5)
    edges = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]]])
    groups = _untyped.graph.connected_component_labels(edges, node_count=len(mesh.vertices))
    of_triangle = groups[mesh.faces[:, 0]]
    for group in np.unique(of_triangle):
        own = mesh.faces[of_triangle == group]
        used, own = np.unique(own, return_inverse=True)
        yield np.asarray(mesh.vertices[used]), np.asarray(own.reshape(-1, 3), dtype=np.int64)


def _hull(points: Array) -> HullMesh:
    """The convex hull; a flat part is thickened first."""
    try:
        hull = hull_mesh(points)
        if hull.volume > FLAT_HULL:
            return hull
    except (QhullError, ValueError):  # points on one plane or line
        pass
    return hull_mesh(np.concatenate([points + THICKENED * s for s in _CORNERS]))


_CORNERS = np.array(
    [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64
)

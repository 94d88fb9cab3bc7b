"""Links as a simulator takes them, and the pairs of them that it would push apart for nothing.

A simulator takes each collision mesh, or each cell that it is cut into, for its convex hull. Such
hulls may meet where the links themselves are apart; then the joint between them is always pressed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from momantu_bt.geometry import Array, Transform
from momantu_skills.manipulation.model.hulls import convex, load_mesh, part_points
from momantu_skills.manipulation.model.shapes import LinkShapes
from momantu_skills.manipulation.model.urdf import CollisionPart
from momantu_skills.robot_setup.urdf.body import Body, Contacts
from momantu_skills.robot_setup.urdf.cells import cuts_of, is_long

CRUMB = 1e-5
"""Least volume of a cell, m3: smaller ones are slivers along a cut, and a simulator leaves them
out."""
OFTEN = 0.1
"""Share of random postures in which hulls meet while the links are apart: above it, no motion of
the joint between them can keep them from pressing."""
HOLLOW, LEAST_HOLLOW = 0.15, 5e-4
"""Share of a hull's volume, and m3, that cutting the mesh must free for it to be cut."""
POSTURES = 60
"""Random postures that are tried."""


def hollow(body: Body, above: float) -> Iterator[str]:
    """Links with a long mesh whose hull fills much that cutting the mesh leaves free.

    Planning takes a long mesh as it is, and leads the arm through its hollows; a simulator that
    takes the hull would stop it there. Links that reach down to `above` m over the floor are left
    out: no arm goes below a base.
    """
    floor = min(body.lowest({}), 0.0)
    for link in dict.fromkeys(part.link for part in body.urdf.parts if is_long(part)):
        if float(body.corners((link,), {})[:, 2].min()) < floor + above:
            continue
        cuts = cuts_of(body, link)
        long = [part for part in body.urdf.parts if part.link == link and is_long(part)]
        whole = sum(_volume(part_points(part)) for part in long)
        cells = sum(_volume(points) for part in long for points in _solids(part, cuts))
        if cuts and whole - cells > max(HOLLOW * whole, LEAST_HOLLOW):
            yield link


def pressing(
    body: Body,
    pairs: Iterable[tuple[str, str]],
    cuts: Mapping[str, Mapping[str, Iterable[float]]],
    poses: Iterable[Mapping[str, float]],
    seed: int = 0,
) -> tuple[tuple[str, str], ...]:
    """Pairs whose hulls meet in a pose, or often, where the links do not.

    cuts: of the meshes that are cut, by link. poses: without a collision of the links themselves.
    """
    every = tuple(pairs)
    shapes = LinkShapes(body.pin, body.hulls)
    for part in body.urdf.parts:
        for points in _solids(part, cuts.get(part.link)):
            shapes.add(part.link, convex(points), Transform())
    hulls, links = Contacts(body, every, shapes=shapes), Contacts(body, every)
    met = np.zeros(len(every), dtype=bool)
    for pose in poses:
        q = body.configuration(pose)
        met |= hulls.meeting(q) & ~links.meeting(q)
    draws = body.random_configurations(POSTURES, seed)
    count = sum(hulls.meeting(q) & ~links.meeting(q) for q in draws)
    met |= np.asarray(count) > OFTEN * POSTURES
    return tuple(pair for pair, pressed in zip(every, met, strict=True) if pressed)


def _solids(part: CollisionPart, cuts: Mapping[str, Iterable[float]] | None) -> Iterator[Array]:
    """Points (n, 3) in the link's frame of each convex solid that a part is taken for."""
    if part.kind != "mesh" or cuts is None:
        yield part_points(part)
        return
    mesh = load_mesh(part)
    corners = np.asarray(mesh.vertices())
    faces = [[mesh.tri_indices(i)[k] for k in range(3)] for i in range(mesh.num_tris)]
    cells = [corners[np.array(faces, dtype=np.int64)]]
    for axis, name in enumerate("xyz"):
        for place in cuts.get(name, ()):
            cells = [
                side for cell in cells for side in _halves(cell, axis, place * part.size[axis])
            ]
    for cell in cells:
        points = np.unique(cell.reshape(-1, 3), axis=0)
        if _volume(points) > CRUMB:
            yield part.link_from_part.apply(points)


def _volume(points: Array) -> float:
    try:
        return float(ConvexHull(points).volume)
    except (QhullError, ValueError):
        return 0.0


def _halves(triangles: Array, axis: int, place: float) -> list[Array]:
    """Triangles (n, 3, 3) on either side of a plane across an axis, crossing ones cut."""
    sides = []
    for sign in (1.0, -1.0):
        above = sign * (triangles[:, :, axis] - place)
        whole, some = (above >= 0).all(axis=1), (above > 0).any(axis=1)
        parts = [triangles[whole & some]]
        for triangle, height in zip(triangles[some & ~whole], above[some & ~whole], strict=True):
            parts.append(_clipped(triangle, height))
        sides.append(np.concatenate(parts))
    return [side for side in sides if len(side)]


def _clipped(triangle: Array, height: Array) -> Array:
    """The part of a triangle (3, 3) where its height (3,) is positive, as triangles (k, 3, 3)."""
    ring = []
    for k in range(3):
        a, b, here, there = triangle[k - 1], triangle[k], height[k - 1], height[k]
        if (here > 0) != (there > 0):
            ring.append(a + (b - a) * (here / (here - there)))
        if there > 0:
            ring.append(b)
    return np.array([[ring[0], ring[k], ring[k + 1]] for k in range(1, len(ring) - 1)])

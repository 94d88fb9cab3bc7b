"""The cells of a floor plan that bodies cover between two heights."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_worlds.scenes.geometry.bodies import Box, Cylinder, Part
from momantu_worlds.scenes.geometry.plane import Rectangle, slab_outline
from momantu_worlds.scenes.geometry.prisms import prism_around
from momantu_worlds.scenes.geometry.solids import outline

UPRIGHT = 1.0 - 1e-9
"""Cosine of the tilt below which a part counts as upright."""
ROUNDING = 1e-9
"""m."""


@dataclass(frozen=True, slots=True)
class Column:
    """One part as a column: the floor under it, and the heights between which it lies, m.

    base: a rectangle; if `round`, only the disc inside it counts. For any other shape, the part is
    the convex hull of `points` (n, 3) in the map.
    """

    base: Rectangle
    bottom: float
    top: float
    round: bool = False
    points: Array | None = None


def columns_of(parts: Iterable[Part], map_from_body: Transform) -> Iterator[Column]:
    """The colliding parts of a body as columns."""
    for part in parts:
        if not part.collision:
            continue
        shape, pose = part.geometry, map_from_body @ part.body_from_part
        upright = float(pose.rotation[2, 2]) >= UPRIGHT
        if not upright or not isinstance(shape, Box | Cylinder):
            points = pose.apply(outline(part))
            prism = prism_around(points, 0.0)
            yield Column(prism.base, prism.bottom, prism.top, points=points)
            continue
        round_ = isinstance(shape, Cylinder)
        size = (
            (2 * shape.radius, 2 * shape.radius) if isinstance(shape, Cylinder) else shape.size[:2]
        )
        height = shape.height if isinstance(shape, Cylinder) else shape.size[2]
        middle = float(pose.position[2])
        base = Rectangle(Pose2D.from_transform(pose), size)
        yield Column(base, middle - height / 2, middle + height / 2, round_)


def covered(
    centers: Array, parts: Iterable[Column], cell: float, band: tuple[float, float]
) -> NDArray[np.bool_]:
    """Cells whose centre lies in what a part has within some heights, m.

    centers: (rows along y, columns along x, 2), `cell` m apart. A part thinner than a cell counts
    as one cell thick.
    """
    low, high = band
    cells = np.zeros(centers.shape[:2], dtype=np.bool_)
    xs, ys = centers[0, :, 0], centers[:, 0, 1]
    for part in parts:
        if part.top < low or part.bottom > high:
            continue
        corners = part.base.corners()
        (x0, y0), (x1, y1) = corners.min(axis=0) - cell, corners.max(axis=0) + cell
        rows = slice(int(np.searchsorted(ys, y0)), int(np.searchsorted(ys, y1, "right")))
        columns = slice(int(np.searchsorted(xs, x0)), int(np.searchsorted(xs, x1, "right")))
        cells[rows, columns] |= _within(centers[rows, columns], part, cell, band)
    return cells


def _within(
    centers: Array, part: Column, cell: float, band: tuple[float, float]
) -> NDArray[np.bool_]:
    pose, size = part.base.pose, part.base.size
    if part.points is not None:
        return _in_convex(centers, slab_outline(part.points, *band), cell)
    if part.round:
        offset = centers - (pose.x, pose.y)
        return np.asarray(np.hypot(offset[..., 0], offset[..., 1]) <= max(size[0], cell) / 2)
    grown = Rectangle(pose, (max(size[0], cell), max(size[1], cell)))
    return np.asarray(grown.distance(centers) <= ROUNDING)


def _in_convex(centers: Array, corners: Array, cell: float) -> NDArray[np.bool_]:
    """Cells whose centre lies in a convex outline (n, 2), counter-clockwise."""
    edges = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(edges[:, 0], edges[:, 1])
    edges, at = edges[lengths > 0] / lengths[lengths > 0, None], corners[lengths > 0]
    if len(edges) == 0:
        return np.asarray(np.linalg.norm(centers - corners[0], axis=-1) <= cell / 2)
    inwards = np.column_stack([-edges[:, 1], edges[:, 0]])
    depth = inwards @ corners.T
    width = float((depth.max(axis=1) - depth.min(axis=1)).min())
    grown = max(0.0, (cell - width) / 2)
    inside = np.ones(centers.shape[:2], dtype=np.bool_)
    for point, normal in zip(at, inwards, strict=True):
        inside &= (centers - point) @ normal >= -grown - ROUNDING
    return inside

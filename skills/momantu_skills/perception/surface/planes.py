"""Measure the level surface that objects stand on, in one view.

The surface is level, so its height is the only unknown. Every height is tried, instead of random
triples of points. The height whose level slice covers the most area is taken, and least squares
refines it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from momantu_bt.detector import View
from momantu_bt.geometry import Array, Transform, quaternion_from_axis_angle
from momantu_skills.perception.geometry.grids import Grid, Mask, closed, largest_component
from momantu_skills.perception.geometry.regions import convex_hull


@dataclass(frozen=True)
class PlaneConfig:
    """How a support surface is found. Lengths in m."""

    slice: float = 0.005
    """Thickness of the slices that are compared; each counts together with its two neighbours."""
    inlier: float = 0.012
    """Largest distance from the plane: three sigma of the depth noise at 1.6 m."""
    cell: float = 0.02
    """Cell size of the grid for the covered area; near points are denser and would otherwise count
    for more."""
    samples: int = 5000
    """Number of points for the fit; more do not improve it."""
    tilt: float = math.radians(2.0)
    """Largest apparent tilt of a level surface: errors of mounting and joints."""
    least_area: float = 0.03
    """Least visible area of a surface, m2."""
    least_spread: float = 0.08
    """Least standard deviation of the points along both axes at which a measured tilt is
    reliable."""


@dataclass(frozen=True, slots=True, eq=False)
class Plane:
    """z = height + slope . (xy - centre). slope (2,), centre (2,) and height in odom, m.

    inliers: (n,) bool over the points it was fitted to, restricted to one connected patch. area:
    visible area of that patch, m2. tilt_known: whether the patch is wide enough for `slope`.
    """

    centre: Array
    height: float
    slope: Array
    inliers: Mask
    area: float
    tilt_known: bool

    def above(self, points: Array) -> Array:
        """(n,) height of points (n, 3) above the plane, m."""
        return np.asarray(points[:, 2] - self.height - (points[:, :2] - self.centre) @ self.slope)


@dataclass(frozen=True, slots=True, eq=False)
class Support:
    """A surface combined from several views.

    height: m in odom. outline: (k, 2) convex hull of its visible part, odom. points: (n, 3) of all
    views in odom, rotated and shifted so that the surface is level and at `height`. on_plane: (n,)
    bool. stamp: of the newest view, s. cameras: (views, 3) positions of the camera.
    """

    height: float
    outline: Array
    points: Array
    on_plane: Mask
    stamp: float
    cameras: Array


def measure_support(
    views: Sequence[View], low: float, high: float, config: PlaneConfig | None = None
) -> Support | None:
    """The surface between the heights `low` and `high` (m, odom), or None if no view shows one.

    Each view is rotated about its camera until the surface is level, which corrects mounting and
    joint errors in height and distance. Then it is shifted up or down to the views' mean height.
    """
    config = config or PlaneConfig()
    found = [(view, find_plane(view.points, low, high, config)) for view in views]
    seen = [(view, plane) for view, plane in found if plane is not None]
    if not seen:
        return None
    level = [_levelled(view, plane) for view, plane in seen]
    weights = np.array([plane.area for _, plane in seen])
    height = float(np.array([z for _, z in level]) @ weights / weights.sum())
    points = np.concatenate([moved + np.array([0.0, 0.0, height - z]) for moved, z in level])
    on_plane = np.concatenate([plane.inliers for _, plane in seen])
    return Support(
        height,
        convex_hull(points[on_plane, :2]),
        points,
        on_plane,
        max(view.snapshot.image.stamp for view, _ in seen),
        np.array([view.camera for view, _ in seen]),
    )


def find_plane(points: Array, low: float, high: float, config: PlaneConfig) -> Plane | None:
    """The level surface among points (n, 3) with the most area between two heights, m."""
    near = points[(points[:, 2] >= low) & (points[:, 2] <= high)]
    near = near[:: max(1, len(near) // config.samples)]
    if len(near) < 50:
        return None
    height = _fullest_slice(near, low, config)
    centre = near[np.abs(near[:, 2] - height) < config.inlier][:, :2].mean(axis=0)
    slope, trusted = np.zeros(2), False
    for limit in (1.5, 1.2, 1.0):
        off = near[:, 2] - height - (near[:, :2] - centre) @ slope
        inliers = near[np.abs(off) < limit * config.inlier]
        if len(inliers) < 50:
            return None
        height, slope, trusted = _least_squares(inliers, centre, config)
    every = points[:, 2] - height - (points[:, :2] - centre) @ slope
    patch, area = _one_patch(points, np.abs(every) < config.inlier, config)
    if area < config.least_area:
        return None
    return Plane(centre, height, slope, patch, area, trusted)


def _fullest_slice(points: Array, low: float, config: PlaneConfig) -> float:
    """Height in m whose slice covers most cells."""
    grid = Grid.over(points[:, :2], config.cell)
    slices = np.floor((points[:, 2] - low) / config.slice).astype(np.int64)
    covered = np.unique(slices * (grid.shape[0] * grid.shape[1]) + grid.cells(points[:, :2]))
    area = np.bincount(covered // (grid.shape[0] * grid.shape[1]))
    smooth = np.convolve(area, [1, 1, 1])[1:-1] if len(area) > 2 else area
    return low + (int(smooth.argmax()) + 0.5) * config.slice


def _least_squares(points: Array, centre: Array, config: PlaneConfig) -> tuple[float, Array, bool]:
    """Height at `centre`, slope (2,), and whether the points are wide enough for the slope."""
    flat = points[:, :2] - centre
    mean, height = flat.mean(axis=0), float(points[:, 2].mean())
    spread = np.cov((flat - mean).T)
    values = np.linalg.eigvalsh(spread)
    if values[0] < config.least_spread**2:
        return height, np.zeros(2), False
    covariance = (flat - mean).T @ (points[:, 2] - height) / (len(points) - 1)
    slope = np.linalg.solve(spread, covariance)
    steep = float(np.hypot(*slope))
    slope *= min(1.0, math.tan(config.tilt) / max(steep, 1e-12))
    return height - float(slope @ mean), slope, True


def _one_patch(points: Array, inliers: Mask, config: PlaneConfig) -> tuple[Mask, float]:
    """Inliers of the largest connected patch, and its area in m2."""
    if not inliers.any():
        return inliers, 0.0
    grid = Grid.over(points[inliers, :2], config.cell)
    cells = grid.cells(points[inliers, :2])
    patch = largest_component(closed(grid.counts(points[inliers, :2]) > 0, 1))
    kept = inliers.copy()
    kept[inliers] = patch.ravel()[cells]
    seen = len(np.unique(cells[patch.ravel()[cells]]))
    return kept, seen * config.cell**2


def levelling(plane: Plane) -> Transform | None:
    """The turn about the camera that levels a plane; None if it is level, or its tilt unknown."""
    if not plane.tilt_known:
        return None
    normal = np.array([-plane.slope[0], -plane.slope[1], 1.0])
    axis = np.cross(normal, [0.0, 0.0, 1.0])
    sine = float(np.linalg.norm(axis)) / float(np.linalg.norm(normal))
    if sine < 1e-9:
        return None
    return Transform(quaternion=quaternion_from_axis_angle(axis, math.asin(sine)))


def _levelled(view: View, plane: Plane) -> tuple[Array, float]:
    """The view's points rotated about its camera so that the plane is level, and its height."""
    turn = levelling(plane)
    if turn is None:
        return view.points, plane.height
    middle = np.array([*plane.centre, plane.height])
    moved = turn.apply(view.points - view.camera) + view.camera
    return moved, float((turn.apply(middle - view.camera) + view.camera)[2])

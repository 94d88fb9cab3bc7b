"""The robot's surroundings as the depth camera saw them: cells, support tops, seen space."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import CameraImage, SupportPlane
from momantu_bt.world import Surface
from momantu_skills.manipulation.config import SceneConfig
from momantu_skills.manipulation.model.collision import Obstacle

GRID = 0.05
"""m; raster in which the points of one surface are taken to hang together."""
EDGE = 0.03
"""m by which a top may reach beyond what was seen of it: pictures have holes at edges, and what
lies beyond their border is taken from the site, beside which furniture stands a little."""
KNOWN_HEIGHT = 0.03
"""m by which it may be higher."""
TOLD_WRONG = 0.12
"""m by which a top may lie beside the height that is told of it and still be the same one."""
BESIDE = 0.37
"""m outside a known surface at which the middle of a seen patch still belongs to it."""
SUPPORT_DEPTH = 0.5
"""m below a support's top that no arm goes: nothing reaches under a table."""
BOARD_DEPTH = 0.06
"""m below the top of a board that hangs over another surface: its thickness, and noise."""
BOARDS_APART = 0.2
"""m of height from which on two surfaces one above the other are two boards, not one badly seen."""
LEAST_CELLS = 6
"""Raster cells below which a patch of points is not a surface."""


KEPT = 12
"""Pictures whose views are remembered: those of a search and of two looks at a grasp."""


@dataclass(frozen=True, eq=False)
class Support:
    """A horizontal top that things stand on. outline: (k, 2) convex, odom, m; height: odom z, m.

    board: it hangs over another surface, and an arm may reach in between.
    """

    outline: Array
    height: float
    board: bool = False

    @property
    def depth(self) -> float:
        """How far below the top no arm goes, m."""
        return BOARD_DEPTH if self.board else SUPPORT_DEPTH

    def obstacle(self, base_from_odom: Transform, name: str) -> Obstacle:
        """The solid below the top, in base, wider than the outline by `EDGE`."""
        wide = _wider(self.outline, EDGE)
        low = np.column_stack([wide, np.full(len(wide), self.height)])
        corners = np.vstack([low, low - (0.0, 0.0, self.depth)])
        return Obstacle(name, base_from_odom.apply(corners), support=True)


@dataclass(frozen=True, eq=False)
class Surroundings:
    """cells: centres (n, 3) of occupied cells, odom, m. stamp: of the newest picture, s."""

    cells: Array = field(default_factory=lambda: np.empty((0, 3)))
    supports: tuple[Support, ...] = ()
    stamp: float = -np.inf

    def without(self, pose: Transform, half_size: tuple[float, float, float]) -> Surroundings:
        """The same without the cells in a box (`odom_from_box`, half its edges in m)."""
        local = np.abs(pose.inverse().apply(self.cells))
        return Surroundings(
            self.cells[~(local <= np.array(half_size)).all(axis=1)], self.supports, self.stamp
        )


def cells_of(points: Array, viewpoint: Array, floor: float, config: SceneConfig) -> Array:
    """Centres (n, 3) of the cells that points (m, 3) occupy, everything in odom.

    Behind each face a thickness is filled, away from `viewpoint` (3,) along the floor, for a
    camera sees fronts only. Points below `floor` are left out.
    """
    points = points[points[:, 2] > floor]
    if not len(points):
        return np.empty((0, 3))
    keys, counts = np.unique(_keys(points, config), axis=0, return_counts=True)
    centres = (keys[counts >= config.points_per_voxel] + 0.5) * config.voxel
    away = centres[:, :2] - viewpoint[:2]
    away /= np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-6)
    layers = [centres]
    for depth in np.arange(config.voxel, config.thickness + 1e-9, config.voxel):
        layers.append(centres + np.column_stack([away * depth, np.zeros(len(away))]))
    filled = np.unique(_keys(np.vstack(layers), config), axis=0)
    return np.asarray((filled + 0.5) * config.voxel)


def _keys(points: Array, config: SceneConfig) -> NDArray[np.int64]:
    return np.floor(points / config.voxel).astype(np.int64)


def support_around(points: Array, centre: Array, height: float, band: float) -> Support | None:
    """The surface at `height` below `centre` (2,), from points (n, 3), all in odom; or None.

    Points within `band` of the height that hang together with the one nearest to the centre.
    """
    flat = points[np.abs(points[:, 2] - height) <= band][:, :2]
    if len(flat) < 3:
        return None
    patch = _connected(flat, centre)
    if patch is None:
        return None
    try:
        return Support(patch[ConvexHull(patch).vertices], height)
    except QhullError:
        return None


def _connected(flat: Array, centre: Array) -> Array | None:
    """Those of points (n, 2) whose raster cells connect to the one nearest to `centre`."""
    keys = np.floor(flat / GRID).astype(np.int64)
    cells = {(int(a), int(b)) for a, b in np.unique(keys, axis=0)}
    nearest = keys[int(np.argmin(np.linalg.norm(flat - centre, axis=1)))]
    seen = {(int(nearest[0]), int(nearest[1]))}
    waiting = deque(seen)
    while waiting:
        a, b = waiting.popleft()
        for next_cell in ((a + i, b + j) for i in (-2, -1, 0, 1, 2) for j in (-2, -1, 0, 1, 2)):
            if next_cell in cells and next_cell not in seen:
                seen.add(next_cell)
                waiting.append(next_cell)
    if len(seen) < LEAST_CELLS:
        return None
    inside = np.array([(int(a), int(b)) in seen for a, b in keys])
    return np.asarray(flat[inside])


def _wider(outline: Array, by: float) -> Array:
    """A convex outline (k, 2) grown by `by` m to all sides: its Minkowski sum with an octagon."""
    angles = np.arange(8) * (np.pi / 4)
    octagon = by * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    corners = (outline[:, None] + octagon).reshape(-1, 2)
    return np.asarray(corners[ConvexHull(corners).vertices])


def known_support(surface: Surface, odom_from_map: Transform) -> Support:
    """A surface of the site, in odom."""
    half = np.array(surface.size) / 2
    corners = [(-half[0], -half[1], 0.0), (half[0], -half[1], 0.0), (*half, 0.0)]
    corners.append((-half[0], half[1], 0.0))
    odom_from_surface = odom_from_map @ surface.map_from_surface.transform(surface.height)
    placed = odom_from_surface.apply(corners)
    return Support(placed[:, :2], float(placed[:, 2].mean()) + KNOWN_HEIGHT)


def same_surface(seen: Support, known: Support) -> bool:
    """Whether a patch that was seen is part of a surface that the site names."""
    near = within(seen.outline.mean(axis=0)[None], known.outline, BESIDE)
    return abs(seen.height + KNOWN_HEIGHT - known.height) < TOLD_WRONG and bool(near[0])


def merged(seen: Support, known: Support) -> Support:
    """What was seen, and what must be there beyond the picture's border, at the height seen."""
    corners = np.vstack([seen.outline, known.outline])
    return Support(corners[ConvexHull(corners).vertices], seen.height)


def within(points: Array, outline: Array, margin: float = 0.0) -> NDArray[np.bool_]:
    """(n,) which points (n, 2) lie in a convex counter-clockwise outline, or `margin` around it."""
    inside = np.ones(len(points), dtype=bool)
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        edge = (b - a) / max(float(np.linalg.norm(b - a)), 1e-9)
        inside &= (points - a) @ np.array([edge[1], -edge[0]]) <= margin
    return inside


def shelved(supports: Sequence[Support]) -> tuple[Support, ...]:
    """The same, those that hang over another of them as boards."""
    return tuple(
        replace(upper, board=any(_hangs_over(upper, lower) for lower in supports))
        for upper in supports
    )


def _hangs_over(upper: Support, lower: Support) -> bool:
    if upper.height - lower.height < BOARDS_APART:
        return False
    middles = upper.outline.mean(axis=0)[None], lower.outline.mean(axis=0)[None]
    return bool(within(middles[0], lower.outline)[0] or within(middles[1], upper.outline)[0])


def support_of_plane(plane: SupportPlane) -> Support:
    """A detected plane as a support in odom."""
    outline = np.array([(x, y, 0.0) for x, y in plane.outline])
    corners = plane.pose.transform.apply(outline)
    return Support(corners[:, :2], float(corners[:, 2].mean()))


@dataclass(frozen=True, eq=False)
class _View:
    odom_from_camera: Transform
    intrinsics: Array
    shape: tuple[int, int]
    nearest: float

    def shows(self, points: Array) -> NDArray[np.bool_]:
        own = self.odom_from_camera.inverse().apply(points)
        z = np.maximum(own[:, 2], 1e-6)
        u = own[:, 0] / z * self.intrinsics[0, 0] + self.intrinsics[0, 2]
        v = own[:, 1] / z * self.intrinsics[1, 1] + self.intrinsics[1, 2]
        height, width = self.shape
        inside = (u >= 0) & (u < width) & (v >= 0) & (v < height)
        return np.asarray(inside & (own[:, 2] > self.nearest))


class SeenSpace:
    """Where the camera has looked, in odom."""

    def __init__(self) -> None:
        self._views: deque[_View] = deque(maxlen=KEPT)

    def add(self, image: CameraImage, odom_from_camera: Transform, nearest: float) -> None:
        """Remember a picture's view. nearest: depth from which on the camera measures, m."""
        height, width = image.depth.shape
        view = _View(odom_from_camera, image.intrinsics, (height, width), nearest)
        self._views.append(view)

    def show(self, points: Array) -> NDArray[np.bool_]:
        """(n,) which points (n, 3) in odom lay in the view of one of the pictures."""
        shown = np.zeros(len(points), dtype=np.bool_)
        for view in self._views:
            shown |= view.shows(points)
        return shown

"""The robot's surroundings from depth pictures: cells, support tops, seen space."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError, cKDTree

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import CameraImage, SupportPlane
from momantu_bt.world import Surface
from momantu_skills.manipulation.config import SceneConfig
from momantu_skills.manipulation.model.collision import Obstacle
from momantu_skills.perception.geometry.rows import unique_rows

GRID = 0.05
"""Grid for connecting the points of one surface, m."""
EDGE = 0.03
"""How far a top may extend beyond its visible part, m: pictures have holes at edges. Beyond a
picture's border the site's data is used, and furniture may stand slightly beside it."""
KNOWN_HEIGHT = 0.03
"""How much higher the top may be, m."""
TOLD_WRONG = 0.12
"""Largest difference between a top's actual height and the height in the site, m."""
BESIDE = 0.37
"""Largest distance of a visible patch's centre outside the outline of the known surface that it
belongs to, m."""
SUPPORT_DEPTH = 0.5
"""Depth below a support's top that is an obstacle, m: the arm never reaches under a table."""
BOARD_DEPTH = 0.06
"""The same for a board that hangs over another surface, m: its thickness, plus noise."""
BOARDS_APART = 0.2
"""Height difference above which two surfaces above each other are two boards, not one with errors,
m."""
FLAT = 10.0
"""Factor on height differences between a filled cell and its face, which are at one height."""
ROUND = 24
"""Corners of the polygon that replaces a round top's edge."""
LEAST_CELLS = 6
"""Fewest grid cells of a patch that counts as a surface."""


STRIDE = 4
"""Every n-th pixel of a kept picture's depth, in each direction."""
KEPT = 12
"""Number of pictures whose views are kept: those of a search and of two views of a grasp."""
FAR_VIEW = 3.0
"""Distance between two pictures above which the older one is forgotten, m: it shows elsewhere."""
DRIFT = (0.011, 0.02)
"""How far odometry may be off for each metre driven and each radian turned, m, at arm's length."""
DRIFTED = 0.08
"""Drift of odometry after which a picture is forgotten, m: where it shows free space, there may be
the thin back of a chair."""


@dataclass(frozen=True, eq=False)
class Support:
    """A horizontal top that objects stand on. outline: (k, 2) convex, odom, m; height: odom z, m.

    board: it hangs over another surface, and the arm may reach in between.
    """

    outline: Array
    height: float
    board: bool = False

    @property
    def depth(self) -> float:
        """Depth below the top that is an obstacle, m."""
        return BOARD_DEPTH if self.board else SUPPORT_DEPTH

    def obstacle(self, base_from_odom: Transform, name: str) -> Obstacle:
        """The obstacle below the top, in base, wider than the outline by `EDGE`."""
        wide = _wider(self.outline, EDGE)
        low = np.column_stack([wide, np.full(len(wide), self.height)])
        corners = np.vstack([low, low - (0.0, 0.0, self.depth)])
        return Obstacle(name, base_from_odom.apply(corners), support=True)


@dataclass(frozen=True, eq=False)
class Surroundings:
    """cells: centres (n, 3) of occupied cells, odom, m. stamp: of the newest picture, s.

    faces: (m, 3) those of the cells in which a camera saw something; the others are filled in
    behind them. None: all of them. fill: how far behind its face a cell may be, m.
    """

    cells: Array = field(default_factory=lambda: np.empty((0, 3)))
    supports: tuple[Support, ...] = ()
    stamp: float = -np.inf
    faces: Array | None = None
    fill: float = 0.0

    def without(
        self, pose: Transform, half_size: tuple[float, float, float], filled: bool = False
    ) -> Surroundings:
        """A copy without the cells in a box (`odom_from_box`, half its edges in m).

        filled: cells beside the box that are filled in behind faces in it are left out too. The
        thickness that is assumed behind the edge of a box seen over a corner lies outside of it.
        """
        kept = self.cells[~_in_box(self.cells, pose, half_size)]
        if not filled or self.faces is None or not len(kept):
            return replace(self, cells=kept)
        x, y, z = half_size
        beside = _in_box(kept, pose, (x + self.fill, y + self.fill, z))
        others = self.faces[~_in_box(self.faces, pose, half_size)]
        if not (beside.any() and len(others)):
            return replace(self, cells=kept[~beside])
        flat = np.array((1.0, 1.0, FLAT))
        behind, _ = cKDTree(others * flat).query(
            kept[beside] * flat, distance_upper_bound=self.fill
        )
        beside[beside] = ~np.isfinite(behind)
        return replace(self, cells=kept[~beside])

    def vacated(self, pose: Transform, half_size: tuple[float, float, float]) -> Surroundings:
        """A copy without all that was seen in a box, or filled in behind it: it was taken away."""
        left = self.without(pose, half_size, filled=True)
        if left.faces is None:
            return left
        return replace(left, faces=left.faces[~_in_box(left.faces, pose, half_size)])


def _in_box(
    points: Array, pose: Transform, half_size: tuple[float, float, float]
) -> NDArray[np.bool_]:
    """Which points (n, 3) lie in a box (`odom_from_box`, half its edges in m): (n,)."""
    local = np.abs(pose.inverse().apply(points))
    return np.asarray((local <= np.array(half_size)).all(axis=1))


def cells_of(points: Array, viewpoint: Array, floor: float, config: SceneConfig) -> Array:
    """Centres (n, 3) of the cells that points (m, 3) occupy, everything in odom.

    As a camera sees only front faces, a thickness behind each face is filled, away from `viewpoint`
    (3,) along the floor. Points below `floor` are left out.
    """
    centres = faces_of(points, floor, config)
    if not len(centres):
        return centres
    away = centres[:, :2] - viewpoint[:2]
    away /= np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-6)
    layers = [centres]
    for depth in np.arange(config.voxel, config.thickness + 1e-9, config.voxel):
        layers.append(centres + np.column_stack([away * depth, np.zeros(len(away))]))
    filled, _ = unique_rows(_keys(np.vstack(layers), config))
    return np.asarray((filled + 0.5) * config.voxel)


def faces_of(points: Array, floor: float, config: SceneConfig) -> Array:
    """Centres (n, 3) of the cells in which points (m, 3) lie; points below `floor` are left out."""
    points = points[points[:, 2] > floor]
    if not len(points):
        return np.empty((0, 3))
    keys, counts = unique_rows(_keys(points, config))
    return np.asarray((keys[counts >= config.points_per_voxel] + 0.5) * config.voxel)


def _keys(points: Array, config: SceneConfig) -> NDArray[np.int64]:
    return np.floor(points / config.voxel).astype(np.int64)


def support_around(points: Array, centre: Array, height: float, band: float) -> Support | None:
    """The surface at `height` below `centre` (2,), from points (n, 3), all in odom; or None.

    It consists of the points within `band` of the height that are connected to the one nearest to
    the centre.
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
    cells = {(int(a), int(b)) for a, b in unique_rows(keys)[0]}
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
    """A convex outline (k, 2) grown by `by` m to all sides: Minkowski sum with an octagon."""
    angles = np.arange(8) * (np.pi / 4)
    octagon = by * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    corners = (outline[:, None] + octagon).reshape(-1, 2)
    return np.asarray(corners[ConvexHull(corners).vertices])


def known_support(surface: Surface, odom_from_map: Transform) -> Support:
    """A surface of the site, in odom."""
    half = np.array(surface.size) / 2
    corners = [(-half[0], -half[1], 0.0), (half[0], -half[1], 0.0), (*half, 0.0)]
    corners.append((-half[0], half[1], 0.0))
    if surface.round:
        turns = np.arange(ROUND) * (2 * np.pi / ROUND)
        corners = [(*(half[0] * np.array([np.cos(t), np.sin(t)])), 0.0) for t in turns]
    odom_from_surface = odom_from_map @ surface.map_from_surface.transform(surface.height)
    placed = odom_from_surface.apply(corners)
    return Support(placed[:, :2], float(placed[:, 2].mean()) + KNOWN_HEIGHT)


def same_surface(seen: Support, known: Support) -> bool:
    """Whether a visible patch is part of a surface of the site."""
    near = within(seen.outline.mean(axis=0)[None], known.outline, BESIDE)
    return abs(seen.height + KNOWN_HEIGHT - known.height) < TOLD_WRONG and bool(near[0])


def merged(seen: Support, known: Support) -> Support:
    """The visible part plus the known part beyond the picture's border, at the visible height."""
    corners = np.vstack([seen.outline, known.outline])
    return Support(corners[ConvexHull(corners).vertices], seen.height)


def within(points: Array, outline: Array, margin: float = 0.0) -> NDArray[np.bool_]:
    """Which points (n, 2) lie in a convex counter-clockwise outline grown by `margin`: (n,)."""
    inside = np.ones(len(points), dtype=bool)
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        edge = (b - a) / max(float(np.linalg.norm(b - a)), 1e-9)
        inside &= (points - a) @ np.array([edge[1], -edge[0]]) <= margin
    return inside


def shelved(supports: Sequence[Support]) -> tuple[Support, ...]:
    """The same supports; those that hang over another one are marked as boards."""
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
    """A picture's view. depth: every STRIDE-th pixel of the picture, m; 0 where not measured."""

    odom_from_camera: Transform
    intrinsics: Array
    shape: tuple[int, int]
    nearest: float
    depth: NDArray[np.float32]
    drift: float
    """`SeenSpace.drift` when the picture was taken, m."""

    @property
    def camera(self) -> Array:
        """Where the picture was taken (3,), odom, m."""
        return self.odom_from_camera.position

    def shows(self, points: Array) -> NDArray[np.bool_]:
        z, u, v = self._pixels(points)
        return self._inside(z, u, v)

    def passes(self, points: Array, slack: float, doubt: float) -> NDArray[np.bool_]:
        """Which points (n, 3) lie before what the picture shows; see `SeenSpace.free`."""
        z, u, v = self._pixels(points)
        inside = np.flatnonzero(self._inside(z, u, v))
        rows, columns = (v[inside] / STRIDE).astype(np.int64), (u[inside] / STRIDE).astype(np.int64)
        before = self.depth[rows, columns] > z[inside] * (1.0 + doubt) + slack
        passed = np.zeros(len(points), dtype=np.bool_)
        passed[inside] = before
        return passed

    def hides(self, points: Array, slack: float) -> NDArray[np.bool_]:
        """Which points (n, 3) lie `slack` m behind what the picture shows, or beside it: (n,).

        Where it measured nothing, as on an arm that is too near, it shows nothing.
        """
        z, u, v = self._pixels(points)
        hidden = ~self._inside(z, u, v)
        inside = np.flatnonzero(~hidden)
        rows, columns = (v[inside] / STRIDE).astype(np.int64), (u[inside] / STRIDE).astype(np.int64)
        depth = self.depth[rows, columns]
        hidden[inside] = depth < z[inside] - slack
        return hidden

    def _pixels(self, points: Array) -> tuple[Array, Array, Array]:
        """Depth, column and row (n,) each of points (n, 3)."""
        own = self.odom_from_camera.inverse().apply(points)
        z = np.maximum(own[:, 2], 1e-6)
        u = own[:, 0] / z * self.intrinsics[0, 0] + self.intrinsics[0, 2]
        v = own[:, 1] / z * self.intrinsics[1, 1] + self.intrinsics[1, 2]
        return own[:, 2], u, v

    def _inside(self, z: Array, u: Array, v: Array) -> NDArray[np.bool_]:
        height, width = self.shape
        inside = (u >= 0) & (u < width) & (v >= 0) & (v < height)
        return np.asarray(inside & (z > self.nearest))


class SeenSpace:
    """The space that the camera has seen, in odom."""

    def __init__(self) -> None:
        self._views = deque[_View](maxlen=KEPT)
        self._base: Transform | None = None
        self.drift = 0.0
        """How far odometry may have drifted so far, m."""
        self.count = 0
        """Number of pictures added so far."""

    def moved(self, odom_from_base: Transform) -> None:
        """Follow the base; forget the pictures that odometry no longer places well enough."""
        before, self._base = self._base, odom_from_base
        if before is None or before == odom_from_base:
            return
        way = float(np.linalg.norm(odom_from_base.position - before.position))
        self.drift += DRIFT[0] * way + DRIFT[1] * before.angle_to(odom_from_base)
        if self._views and self.drift - self._views[0].drift > DRIFTED:
            kept = (view for view in self._views if self.drift - view.drift <= DRIFTED)
            self._views = deque(kept, maxlen=KEPT)

    def add(self, image: CameraImage, odom_from_camera: Transform, nearest: float) -> None:
        """Add a picture's view. nearest: least depth that the camera measures, m."""
        height, width = image.depth.shape
        depth = np.array(image.depth[::STRIDE, ::STRIDE])
        size = (height, width)
        view = _View(odom_from_camera, image.intrinsics, size, nearest, depth, self.drift)
        here = odom_from_camera.position[:2]
        near = [v for v in self._views if np.linalg.norm(v.camera[:2] - here) < FAR_VIEW]
        self._views = deque([*near, view], maxlen=KEPT)
        self.count += 1

    def show(self, points: Array) -> NDArray[np.bool_]:
        """Which points (n, 3) in odom were in the view of one of the pictures: (n,)."""
        shown = np.zeros(len(points), dtype=np.bool_)
        for view in self._views:
            shown |= view.shows(points)
        return shown

    def hidden(self, points: Array, slack: float) -> NDArray[np.bool_]:
        """Which points (n, 3) in odom the newest picture does not show: (n,).

        They lie beside it, or `slack` m behind what it shows.
        """
        if not self._views:
            return np.ones(len(points), dtype=np.bool_)
        return self._views[-1].hides(points, slack)

    def free(self, points: Array, slack: float, doubt: float = 0.0) -> NDArray[np.bool_]:
        """Which points (n, 3) in odom a picture has shown to be free: (n,).

        What the picture shows must lie behind them by `slack` m and by the share `doubt` of their
        depth.
        """
        free = np.zeros(len(points), dtype=np.bool_)
        for view in self._views:
            left = np.flatnonzero(~free)
            free[left] = view.passes(points[left], slack, doubt)
        return free

"""The planning scene's content: body, surroundings, masks, collision worlds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import DetectedObject, RobotState, SupportPlane
from momantu_bt.robot import RobotDescription
from momantu_bt.service import HeldObject, Snapshot
from momantu_skills.manipulation.config import PlanningConfig, SceneConfig
from momantu_skills.manipulation.model.arm_model import arm_model
from momantu_skills.manipulation.model.collision import (
    Attached,
    Cells,
    CollisionWorld,
    Obstacle,
)
from momantu_skills.manipulation.scene import outreach
from momantu_skills.manipulation.scene.columns import DOUBT, HALF_DIAGONAL, WALL, Columns
from momantu_skills.manipulation.scene.dropped import dropped
from momantu_skills.manipulation.scene.own_body import OwnBody
from momantu_skills.manipulation.scene.recent import RecentPictures
from momantu_skills.manipulation.scene.site_obstacles import Overhead, hanging
from momantu_skills.manipulation.scene.surroundings import (
    SeenSpace,
    Support,
    Surroundings,
    cells_of,
    faces_of,
    merged,
    same_surface,
    shelved,
    support_around,
    support_of_plane,
    within,
)
from momantu_skills.manipulation.scene.swept import swept
from momantu_skills.perception.camera.cloud import points_from_depth
from momantu_skills.perception.geometry.rows import unique_rows

PER_METRE = 1e4
"""Places of cells are whole tenths of a millimetre, so that a cell seen twice is one cell."""
SUPPOSED = PlanningConfig().supposed[0]
"""How much nearer than on its maps what may be as tall as a wall stands, m, where nobody says."""
FORGET = 2.0
"""Distance from the base above which cells and supports are deleted, m, because odometry has
drifted since."""
SAME_HEIGHT = 0.06
"""Height difference within which a new support replaces an older one that it overlaps, m."""
DISC = 0.25
"""Radius of the assumed support below an object of which too little is visible, m."""
FLOOR_BAND = 0.06
"""Height above the floor below which points belong to the floor, m."""
SEEN_THROUGH = 0.03
"""An old cell is deleted if the picture shows something this much behind it, m."""


class Cut(NamedTuple):
    """A box in which cells do not count: `odom_from_box`, and half its edges in m.

    filled: cells that are only filled in behind faces in the box do not count either.
    """

    pose: Transform
    half_size: tuple[float, float, float]
    filled: bool = False


class Scene:
    """See `PlanningSceneService`, which owns one."""

    def __init__(self, description: RobotDescription, config: SceneConfig) -> None:
        self.config = config
        self.model = arm_model(description)
        self.surroundings = Surroundings()
        self.points: Array = np.empty((0, 3))
        self.recent = RecentPictures(self._seen)
        self.known: tuple[Support, ...] = ()
        self.overhead: tuple[Overhead, ...] = ()
        self.columns: Columns | None = None
        self.odom_from_map: Transform | None = None
        self.seen_space = SeenSpace()
        self.own = OwnBody(self.model, config.robot_padding)
        if description.has_arm:
            self.own.pairs  # noqa: B018  # built before the run begins, as it takes a while

    @property
    def _reach(self) -> float:
        """Distance from the base where elbow, hand or load may meet obstacles, m."""
        working = self.model.description.working
        farthest = working.look_off if working.reach is None else working.reach[2]
        return farthest + self.config.beyond_reach

    # seeing

    def observe(self, snapshot: Snapshot, held: HeldObject | None) -> None:
        """Update the cells that a depth picture shows."""
        image, odom_from_camera = snapshot.image, snapshot.odom_from_camera
        nearest = self.model.description.camera()[1].min_depth
        self.seen_space.add(image, odom_from_camera, nearest)
        self.points = self._seen(snapshot, held)
        self.recent.add(snapshot, held)
        new = cells_of(self.points, odom_from_camera.position, FLOOR_BAND, self.config)
        cells = self._with_older(new, self.surroundings.cells, snapshot)
        new = faces_of(self.points, FLOOR_BAND, self.config)
        faces = self._with_older(new, self.surroundings.faces, snapshot)
        near = [
            support
            for support in self.surroundings.supports
            if _distance(support.outline, snapshot.odom_from_base) < FORGET
        ]
        fill = self.config.thickness + self.config.voxel
        self.surroundings = Surroundings(cells, tuple(near), image.stamp, faces, fill)

    def _with_older(self, new: Array, old: Array | None, snapshot: Snapshot) -> Array:
        """Cells (n, 3) of a picture and older ones that it does not contradict, each once."""
        if old is not None:
            new = np.vstack([old[self._still_believed(old, snapshot)], new])
        places = np.rint(new * PER_METRE).astype(np.int64)
        return np.asarray(unique_rows(places)[0] / PER_METRE)

    def _seen(self, snapshot: Snapshot, held: HeldObject | None, stride: int = 0) -> Array:
        """Points (n, 3) in odom of the picture, without the robot, within its reach."""
        image, odom_from_base = snapshot.image, snapshot.odom_from_base
        every = stride or self.config.pixel_stride
        optical = points_from_depth(image.depth, image.intrinsics, every)
        base_points = (odom_from_base.inverse() @ snapshot.odom_from_camera).apply(optical)
        base_points = base_points[np.linalg.norm(base_points[:, :2], axis=1) < self._reach]
        own = self.own.covers(base_points, snapshot.state, held)
        return odom_from_base.apply(base_points[~own])

    def _still_believed(self, cells: Array, snapshot: Snapshot) -> NDArray[np.bool_]:
        """Which older cells are near and were not seen through in the new picture: (n,)."""
        image, base = snapshot.image, snapshot.odom_from_base.position
        near = np.linalg.norm(cells[:, :2] - base[:2], axis=1) < FORGET
        optical = snapshot.odom_from_camera.inverse().apply(cells)
        z = np.maximum(optical[:, 2], 1e-3)
        k, (height, width) = image.intrinsics, image.depth.shape
        u = np.round(optical[:, 0] / z * k[0, 0] + k[0, 2]).astype(np.int64)
        v = np.round(optical[:, 1] / z * k[1, 1] + k[1, 2]).astype(np.int64)
        inside = (optical[:, 2] > 0.1) & (u >= 0) & (u < width) & (v >= 0) & (v < height)
        depth = image.depth[np.clip(v, 0, height - 1), np.clip(u, 0, width - 1)]
        gone = inside & (depth > z + SEEN_THROUGH)
        return np.asarray(near & ~gone)

    def add_support(self, plane: SupportPlane) -> None:
        """Add a measured surface."""
        self._remember(support_of_plane(plane))

    def support_below(self, thing: DetectedObject) -> Support:
        """The surface that an object stands on, according to the newest picture."""
        centre = thing.pose.position[:2]
        found = support_around(self.points, centre, thing.support_height, self.config.surface_band)
        if found is None:
            angles = np.linspace(0.0, 2 * np.pi, 12, endpoint=False)
            ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
            found = Support(centre + DISC * ring, thing.support_height)
        return self._remember(found)

    def _remember(self, support: Support) -> Support:
        for known in self.known:
            if same_surface(support, known):
                support = merged(support, known)
        centre = support.outline.mean(axis=0)
        others = [
            other
            for other in self.surroundings.supports
            if abs(other.height - support.height) > SAME_HEIGHT
            or float(np.linalg.norm(other.outline - centre, axis=1).min()) > 1.0
        ]
        self.surroundings = replace(self.surroundings, supports=(*others, support))
        return support

    def met(self, state: RobotState, passed: Array, ahead: Array) -> None:
        """Take over that something stopped the arm on its way to joints `ahead` (n,).

        It is where links would have come that did not get there at joints `passed` (k, n), and
        where no picture shows that nothing is; later pictures may show it.
        """
        edge = self.config.voxel
        found = swept(self.model, self.own.pairs.moving, state, passed, ahead, edge)
        found = found[~self.seen_space.free(found, HALF_DIAGONAL * edge, DOUBT)]
        places = np.rint(np.vstack([self.surroundings.cells, found]) * PER_METRE).astype(np.int64)
        cells = np.asarray(unique_rows(places)[0] / PER_METRE)
        self.surroundings = replace(self.surroundings, cells=cells)

    def taken(self, thing: DetectedObject, margin: tuple[float, float, float]) -> None:
        """Forget what was seen of an object that is in the hand now, where it stood.

        margin: beyond half the object's size along its axes, m.
        """
        x, y, z = (edge / 2 + more for edge, more in zip(thing.size, margin, strict=True))
        self.surroundings = self.surroundings.vacated(thing.pose.transform, (x, y, z))

    # asking

    def dropped(self, state: RobotState, held: HeldObject) -> Array:
        """Points (n, 2) of the floor, odom, on which what was held may lie; none over a surface."""
        there = self.own.corners(state, held)[-1].mean(axis=0)
        odom = state.odom_from_base.apply(there)
        for support in self._supports(state):
            if support.height <= odom[2] and within(odom[None, :2], support.outline)[0]:
                return np.empty((0, 2))
        front = max(x for x, _ in self.model.description.footprint)
        return dropped(state, there, max(held.object.size), front)

    def world(
        self,
        state: RobotState,
        held: HeldObject | None,
        margin: float,
        *,
        width: float | None = None,
        held_on_support: bool = False,
        cut: Cut | None = None,
        extra: tuple[Obstacle, ...] = (),
        supposed: float | None = SUPPOSED,
    ) -> CollisionWorld:
        """A collision world for the current state. Everything is placed by the state's odometry.

        width: the gripper's opening for the check, m; the measured one if None. held_on_support:
        the held object may touch supports. cut: a box in which cells are ignored. extra: additional
        solids. supposed: what the maps know is as tall as a wall where no picture has seen over it,
        and may be this much nearer, m; None: only what is known of its height counts.
        """
        base_from_odom = state.odom_from_base.inverse()
        around = self.surroundings if cut is None else self.surroundings.without(*cut)
        supports = self._supports(state)
        seen = self._uncovered(around.cells, supports[: len(around.supports)])
        tall = None if supposed is None else self._tall(state, supposed)
        attached = None if held is None else Attached(self.own.held_corners(held))
        return CollisionWorld(
            self.own.pairs,
            self.model.configuration(state, width),
            obstacles=[
                *(s.obstacle(base_from_odom, f"support {i}") for i, s in enumerate(supports)),
                *hanging(self.overhead, base_from_odom, FORGET),
                *extra,
            ],
            cells=[
                Cells("cells", seen, self.config.voxel, base_from_odom),
                *(() if tall is None else (tall,)),
            ],
            attached=attached,
            margin=margin,
            held_on_support=held_on_support,
        )

    def solids(self, state: RobotState, hits: Array, reach: float) -> Array:
        """See `BodyScene.solids`."""
        base_from_odom = state.odom_from_base.inverse()
        supports = self._supports(state)
        tall, radius = self._tall_near(state, reach)
        hits = outreach.unexplained(outreach.beside(hits, supports, base_from_odom), tall)
        found = np.vstack(
            [outreach.standing(hits, WALL, 0.0), outreach.standing(tall, WALL, radius)]
        )
        return np.asarray(found[np.hypot(found[:, 0], found[:, 1]) < reach])

    def _tall_near(self, state: RobotState, reach: float) -> tuple[Array, float]:
        """Points (n, 2), base frame, of what the maps know near, and their radius.

        They reach to where the map draws them. A wall may end up to half a cell beyond, and the
        base may be some centimetres off: the guard's margin is left for that.
        """
        if self.columns is None or self.odom_from_map is None:
            return np.empty((0, 2)), 0.0
        map_from_base = self.odom_from_map.inverse() @ state.odom_from_base
        x, y, _ = map_from_base.position
        tall = self.columns.near(float(x), float(y), reach)
        flat = map_from_base.inverse().apply(np.column_stack([tall, np.zeros(len(tall))]))
        return flat[:, :2], self.columns.edge / 2

    def not_free(self, state: RobotState, columns: Array) -> Array:
        """See `BodyScene.not_free`."""
        pieces = outreach.cut(columns)
        free = np.ones(len(pieces), dtype=np.bool_)
        for points in outreach.samples(pieces):
            there = state.odom_from_base.apply(points[free])
            free[free] = self.seen_space.free(there, HALF_DIAGONAL * outreach.GRID, DOUBT)
        return np.asarray(pieces[~free])

    def near_columns(self, state: RobotState) -> bool:
        """Whether the maps know anything within reach that may be as tall as a wall."""
        if self.columns is None or self.odom_from_map is None:
            return False
        x, y, _ = (self.odom_from_map.inverse() @ state.odom_from_base).position
        return len(self.columns.near(float(x), float(y), self._reach)) > 0

    def _tall(self, state: RobotState, doubt: float) -> Cells | None:
        """What the maps know near the base, as tall as a wall where no picture has seen over it."""
        if self.columns is None or self.odom_from_map is None:
            return None
        return self.columns.cells(
            state.odom_from_base, self.odom_from_map, self.seen_space, self._reach, doubt
        )

    def _supports(self, state: RobotState) -> tuple[Support, ...]:
        """The surfaces that pictures have shown, then those that the site knows besides."""
        return shelved((*self.surroundings.supports, *self._unseen(state.odom_from_base)))

    def _uncovered(self, cells: Array, supports: Sequence[Support]) -> Array:
        """The cells (n, 3) that belong to none of the supports."""
        for support in supports:
            cells = cells[~self._covered(cells, support)]
        return cells

    def _unseen(self, odom_from_base: Transform) -> list[Support]:
        """Surfaces near the base that are in the site and that no picture has shown yet."""
        seen = self.surroundings.supports
        return [
            known
            for known in self.known
            if _distance(known.outline, odom_from_base) < FORGET
            and not any(same_surface(other, known) for other in seen)
        ]

    def _covered(self, cells: Array, support: Support) -> NDArray[np.bool_]:
        """Which cells belong to the support, (n,): inside its outline, not above its top.

        Cells below it belong to it too, unless it is a board that hangs over other objects.
        """
        low = cells[:, 2] < support.height + self.config.surface_band + self.config.voxel / 2
        if support.board:
            low &= cells[:, 2] > support.height - support.depth
        return np.asarray(low & within(cells[:, :2], support.outline, self.config.voxel))


def _distance(outline: Array, odom_from_base: Transform) -> float:
    return float(np.linalg.norm(outline - odom_from_base.position[:2], axis=1).min())

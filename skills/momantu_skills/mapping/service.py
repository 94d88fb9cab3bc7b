"""The mapping service: the robot's map and its pose on it, both from its own scans."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from momantu_bt.descriptions.tunables import configured
from momantu_bt.failure import SENSOR_DEAD, Failure
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Array, Pose2D
from momantu_bt.lazy import lazily
from momantu_bt.robot import Robot, read_laser
from momantu_bt.service import Service, ServiceContext
from momantu_skills.navigation.config import LocalizationConfig, NavigationConfig
from momantu_skills.navigation.localize.confidence import published
from momantu_skills.navigation.map.sensing import Rays
from momantu_skills.navigation.matching.poses import ORIGIN

with lazily():
    from momantu_skills.mapping import (
        anchors,
        extending,
        fitting,
        growing_plan,
        sightings,
        uncertainty,
    )
    from momantu_skills.mapping import survey as surveys
    from momantu_skills.mapping.logs import log
    from momantu_skills.navigation.control import footprint
    from momantu_skills.navigation.map import costmap as costmaps

if TYPE_CHECKING:
    from momantu_skills.mapping.extending import Earlier

RESOLUTION = 0.05
"""Cell of the map, m."""
STEP = 5.0
"""By how much the map's raster grows, m: seldom, as drives then need new plans."""
REFRESH = 1.0
"""Time between two updates of the costmap, s; until then its own layers have what the laser saw."""
MOVING = 1e-4
"""Motion per update below which the base counts as at rest, m and rad."""
REST_SCANS, RESET_SCANS = 3, 15
"""Scans at rest that are compared with the map, after a motion and after a reset."""


class MappingService(Service):
    """Maps and localizes at once: it takes the place of `localization` in a run that has it.

    It publishes what `localization` does, and `known`, the square metres of free floor that the map
    has, and `loops`, how many loops are closed.

    A run has it if one of its skills needs it, such as `explore`, or if its tree reads
    `$@mapping.known`. The run is then told no floor plan, no places and no surfaces; the map begins
    where the site says that the robot starts. Whoever drives shares the service's costmap.

    Where a match is bad, for example after somebody has carried the robot away, the quality says
    so. `reset` and `spread` look anew: around a pose, and around the estimate. There is no map of
    other places in which to look.
    """

    rate: ClassVar[float] = 10.0
    publishes: ClassVar[Mapping[str, type]] = {
        "quality": float,
        "sigma_position": float,
        "sigma_yaw": float,
        "pose": Pose2D,
        "known": float,
        "loops": int,
    }
    earlier: Earlier | None = None
    """The map with which a run goes on; set before it starts. The first scan says where it is."""
    unplaced: str = ""
    """Why the run does not go on with it: the first scan does not fit."""
    begun: Pose2D | None = None
    """`map_from_base` of the first scan on it."""
    senses = ("laser",)
    replaces = ("localization",)
    charts = True

    def start(self, context: ServiceContext) -> None:
        """Begin an empty map at the site's start pose."""
        self._config = configured(
            NavigationConfig, context.site.services.get("navigate", {}), "navigate"
        )
        told = context.site.services.get("localization", {})
        self._uncertainty = uncertainty.Uncertainty(
            configured(LocalizationConfig, told, "localization")
        )
        self._frames = context.frames
        self._laser = context.description.laser()[0]
        self._base = context.description.base_frame
        self.stands: float = footprint.half_width(np.array(context.description.footprint))
        self._start = context.site.start
        self.survey: surveys.Survey = surveys.Survey(context.site.start)
        self.anchors: anchors.Anchors = anchors.Anchors(context.site)
        if self.earlier is not None:
            self.anchors.hold_all(self.earlier.known.graph.poses)
        self._plan = growing_plan.GrowingPlan(RESOLUTION, STEP, self.stands)
        self._costmap: costmaps.Costmap | None = None
        self._odom_from_base: Pose2D | None = None
        self._odometry = ORIGIN
        self._estimate = context.site.start
        self._score = self._fit = 1.0
        self._newest: tuple[int, Pose2D] | None = None
        self._due_at = -math.inf
        self._rest_scans = RESET_SCANS
        self._told = False
        self.sightings: sightings.Sightings = sightings.Sightings()

    def update(self, robot: Robot, now: float) -> None:
        """Follow odometry; use a scan when the base has moved, and compare some at rest."""
        self.anchors.note(self.survey.mapper.poses)
        odom_from_base = Pose2D.from_transform(robot.state().odom_from_base)
        before = self._odom_from_base or odom_from_base
        self._odom_from_base = odom_from_base
        step = before.inverse() @ odom_from_base
        moving = abs(step.x) + abs(step.y) + abs(step.yaw) > MOVING
        if moving:
            self._rest_scans = max(self._rest_scans, REST_SCANS)
        if self.survey.due(self._odometry @ odom_from_base) or (
            not moving and self._rest_scans > 0
        ):
            self._use_scan(robot, moving)
        elif self._told and not moving:
            return
        if not self.survey.used:
            return
        self._told = True
        self._estimate = self.survey.pose(self._odometry @ odom_from_base)
        map_from_odom = self._estimate @ odom_from_base.inverse()
        self._frames.set_map_from_odom(map_from_odom.transform(), now)
        if now >= self._due_at:
            self._due_at = now + REFRESH
            self.refresh()

    def _use_scan(self, robot: Robot, moving: bool) -> None:
        try:
            scan = read_laser(robot, self._laser)
        except Failure as failure:
            if failure.code != SENSOR_DEAD:
                raise
            return
        self._rest_scans -= 0 if moving else 1
        rays = Rays.from_scan(scan, self._frames.lookup(self._base, scan.frame, scan.stamp))
        there = self._frames.lookup(ODOM, self._base, scan.stamp)
        odometry = self._odometry @ Pose2D.from_transform(there)
        if self.earlier is not None and not self.survey.used:
            try:
                self.begun = extending.begun_at(self.earlier, self._start, rays)
            except Failure as failure:
                self.unplaced = failure.value.message
                raise
            self.survey = surveys.Survey.going_on(self.earlier.known, self.begun)
        revision = self.survey.mapper.revision
        before = odometry if self.survey.begins else self.survey.used[-1].odom_from_base
        tracked = self.survey.add(log.LoggedScan(scan.stamp, odometry, rays))
        if self.survey.mapper.revision != revision:
            self.anchors.move(self.survey.mapper.poses)
        if tracked is not None:
            self._score = tracked.score
            self._uncertainty.follow(before.inverse() @ odometry, tracked)
        if self._costmap is not None:
            at = self.survey.pose(odometry)
            self._fit = fitting.fit(self._costmap.grid, self._surfaces, at, rays)

    def refresh(self) -> None:
        """Bring the costmap up to date with the newest scan."""
        if not self._plan.follow(self.survey):
            return
        poses, moved = self.survey.mapper.poses, ORIGIN
        if self._newest is not None:
            last, pose = self._newest
            moved = ORIGIN if poses[last] == pose else poses[last] @ pose.inverse()
        self._newest = len(poses) - 1, poses[-1]
        grid = self._plan.grid()
        self._surfaces = fitting.surfaces(grid)
        if self._costmap is None:
            self._costmap = costmaps.Costmap(grid, None, self._config, grows=True)
        else:
            self._costmap.use(grid, moved)

    @property
    def costmap(self) -> costmaps.Costmap:
        """The costmap on the growing map, which all who drive share; its raster may grow.

        Raises:
            Failure: SENSOR_DEAD, there has been no scan yet.
        """
        if self._costmap is None:
            raise Failure(SENSOR_DEAD, "there is no map yet: the laser has not shown anything")
        return self._costmap

    @property
    def loops(self) -> int:
        """How many loops are closed."""
        return len(self.survey.mapper.loops)

    @property
    def map_from_base(self) -> Pose2D:
        """The current best estimate."""
        return self._estimate

    @property
    def covariance(self) -> Array:
        """(3, 3) of x, y, yaw in m2, m rad, rad2, relative to the map around the robot."""
        turn, yaw = np.eye(3), self._estimate.yaw
        turn[:2, :2] = [[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]]
        return np.asarray(turn @ self._uncertainty.covariance @ turn.T)

    @property
    def quality(self) -> float:
        """0..1: how well the newest scan fits what is known of the map; see `fitting.fit`."""
        broken = self._score < self.survey.mapper.config.broken_score
        return min(self._fit, self._score) if broken else self._fit

    def reset(self, map_from_base: Pose2D, sigma_position: float, sigma_yaw: float) -> None:
        """Go on at a pose, as if the base had driven there; the next scan corrects it.

        The standard deviations are not used: a match is looked for as far as odometry may be off.
        """
        self._rest_scans = RESET_SCANS
        if self._odom_from_base is None or not self.survey.used:
            return
        if map_from_base != self._estimate:
            last, pose = self.survey.used[-1].odom_from_base, self.survey.mapper.poses[-1]
            there = last @ (pose.inverse() @ map_from_base)
            self._odometry = there @ self._odom_from_base.inverse()
            self._estimate = map_from_base

    def spread(self) -> None:
        """Look anew at the estimate."""
        self._rest_scans = RESET_SCANS

    def published(self) -> Mapping[str, Any]:
        """What localization tells, known in m2, and loops."""
        return {**published(self), "known": self.known, "loops": self.loops}

    @property
    def known(self) -> float:
        """Square metres of free floor that the map has."""
        if self._costmap is None:
            return 0.0
        return self._costmap.grid.free_area

"""The localization service: publishes the odom frame's pose in the map after each scan."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from momantu_bt.descriptions.tunables import configured
from momantu_bt.failure import SENSOR_DEAD, Failure
from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_bt.lazy import lazily
from momantu_bt.robot import Robot, read_laser
from momantu_bt.service import Service, ServiceContext
from momantu_skills.navigation.config import LocalizationConfig
from momantu_skills.navigation.localize.confidence import published
from momantu_skills.navigation.map.believed import believed_maps, corrections
from momantu_skills.navigation.map.sensing import Rays

with lazily():
    from momantu_skills.navigation.localize import localizer, scan_odometry


MOVING = 1e-4
"""Motion per update below which the base counts as at rest, m and rad."""


class LocalizationService(Service):
    """Adaptive Monte Carlo localization; see `LocalizationConfig` for the site's parameters.

    It uses the laser when odometry has moved, and for a while at rest after a reset or a stop. The
    laser is assumed to be fixed to the base. If the laser fails, the service follows odometry
    alone, and skills that drive report the failure themselves. When scans return, the first one is
    used. Where the site has no map, odometry says where the robot is, corrected by laying each scan
    onto those of the last metres, in a map's frame that begins at the site's start.
    """

    rate: ClassVar[float] = 10.0
    publishes: ClassVar[Mapping[str, type]] = {
        "quality": float,
        "sigma_position": float,
        "sigma_yaw": float,
        "pose": Pose2D,
    }
    senses = ("laser",)

    def start(self, context: ServiceContext) -> None:
        """Read the map and start around the site's start pose."""
        self._config = configured(LocalizationConfig, context.parameters, "localization")
        self._frames = context.frames
        self._laser = context.description.laser()[0]
        self._base = context.description.base_frame
        self._site, self._corrections = context.site, corrections(context.site)
        self._localizer: localizer.Localizer | scan_odometry.ScanOdometry
        if context.site.map_file is None:
            self._localizer = scan_odometry.ScanOdometry(context.site.start)
        else:
            grid = believed_maps(context.site)[0]
            self._localizer = localizer.Localizer(grid, self._config, context.random)
        self._odom_from_base: Pose2D | None = None
        self._since_scan = [0.0, 0.0]
        self._rest_scans = 0
        self._base_from_laser: Transform | None = None
        self._told = False
        self.reset(context.site.start, *context.site.start_sigma)

    def update(self, robot: Robot, now: float) -> None:
        """Follow odometry; use a scan when it is due."""
        odom_from_base = Pose2D.from_transform(robot.state().odom_from_base)
        before = self._odom_from_base or odom_from_base
        self._odom_from_base = odom_from_base
        delta = before.inverse() @ odom_from_base
        way, turn = before.distance_to(odom_from_base), abs(delta.yaw)
        moving = way > MOVING or turn > MOVING
        if moving:
            self._localizer.move(delta)
            self._since_scan[0] += way
            self._since_scan[1] += turn
            self._rest_scans = max(self._rest_scans, 3)
        self._follow_map()
        if self._due(moving):
            self._weigh(robot, moving)
        elif self._told:
            return
        self._told = True
        map_from_odom = self._localizer.estimate @ odom_from_base.inverse()
        self._frames.set_map_from_odom(map_from_odom.transform(), now)

    def _follow_map(self) -> None:
        """Use the map with a surface that was found elsewhere, and look at it anew."""
        if self._site.map_file is not None and corrections(self._site) != self._corrections:
            self._corrections = corrections(self._site)
            self._localizer.use_map(believed_maps(self._site)[0])
            self._rest_scans = self._config.rest_scans

    def _due(self, moving: bool) -> bool:
        far = self._since_scan[0] > self._config.move or self._since_scan[1] > self._config.turn
        return far or (not moving and self._rest_scans > 0)

    def _weigh(self, robot: Robot, moving: bool) -> None:
        try:
            rays = self._rays(robot)
        except Failure as failure:
            if failure.code != SENSOR_DEAD:
                raise
            return
        if not moving:
            self._rest_scans -= 1
            self._localizer.jitter(self._config.rest_jitter)
        self._since_scan = [0.0, 0.0]
        sought = self._localizer.lost
        self._localizer.observe(rays)
        if sought and not self._localizer.lost:
            self._rest_scans = self._config.rest_scans

    def _rays(self, robot: Robot) -> Rays:
        scan = read_laser(robot, self._laser)
        if self._base_from_laser is None:
            self._base_from_laser = self._frames.lookup(self._base, scan.frame, scan.stamp)
        return Rays.from_scan(scan, self._base_from_laser)

    @property
    def map_from_base(self) -> Pose2D:
        """The current best estimate."""
        return self._localizer.estimate

    @property
    def covariance(self) -> Array:
        """(3, 3) of x, y, yaw in m2, m rad, rad2; other hypotheses enlarge it."""
        return self._localizer.covariance

    @property
    def quality(self) -> float:
        """0..1: how well the newest scan fits the map at the estimate (see `scan_fit`)."""
        return self._localizer.quality

    @property
    def places(self) -> tuple[Pose2D, ...]:
        """Where the robot may be while it is sought on the whole map, likeliest first."""
        return tuple(place.pose for place in self._localizer.places)

    def reset(self, map_from_base: Pose2D, sigma_position: float, sigma_yaw: float) -> None:
        """Restart around a pose; standard deviations in m and rad."""
        self._localizer.reset(map_from_base, sigma_position, sigma_yaw)
        self._rest_scans = self._config.rest_scans

    def spread(self) -> None:
        """Restart everywhere on the map's free floor."""
        self._localizer.spread()
        self._rest_scans = self._config.rest_scans

    def published(self) -> Mapping[str, Any]:
        """See `confidence.published`."""
        return published(self)

"""What laser and cameras show of the floor while the base drives: it fills the costmap."""

from __future__ import annotations

import numpy as np

from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_bt.lazy import lazily
from momantu_bt.robot import CameraSensor, Robot, read_camera, read_laser
from momantu_bt.skill import Skill
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.drive.body import Body, BodyScene
from momantu_skills.navigation.map.sensing import Rays, obstacles_and_floor

with lazily():
    from momantu_skills.navigation.control import guard
    from momantu_skills.navigation.drive import overlooked, people
    from momantu_skills.navigation.map import costmap

TURN_BETWEEN_LOOKS = 0.8
"""Turn that counts like `depth_every` metres of driving, rad: about half of a camera's view."""
LASER_DOUBT = 0.03
"""How far below its plane a laser may look over a thing, m: noise of heights, tilt of the laser."""
FEW = 0.02
"""Share of a picture's points that may be nearer than where it begins to show things."""
UNDER = 0.05
"""Distance beside the base up to which nothing lies where it stands, m: one cell."""


class Sight:
    """Enters scans and pictures into a costmap, and keeps what the collision guard needs of them.

    The laser is assumed to be fixed to the base.

    blind: how near the last picture began to show the floor, m. earlier: points (n, 2) of low
    things, in the map, m, that the next scan brings into the costmap.
    """

    def __init__(
        self,
        skill: Skill,
        robot: Robot,
        scene: BodyScene,
        config: NavigationConfig,
        shown: costmap.Costmap,
        earlier: Array,
    ) -> None:
        """shown: the costmap. earlier: what it lacks."""
        self._frames, self._robot, self._scene, self._config = skill.frames, robot, scene, config
        self._costmap, self.earlier = shown, earlier
        self.pictures = any(
            isinstance(sensor, CameraSensor) for sensor in robot.description.sensors.values()
        )
        self.blind = 0.0
        self._base_from_laser: Transform | None = None
        self._hits = np.zeros((0, 2))
        self._people = people.People(shown)
        self._overlooked = overlooked.Overlooked()

    def see(self, map_from_odom: Pose2D, body: Body, base_discs: Array, *, depth: bool) -> None:
        """Add a scan, and a depth picture if the last one was taken far behind.

        body: is told of the scan. base_discs: of the base alone. depth: whether pictures are read.
        """
        odom_from_base = self._odom_from_base()
        pose = map_from_odom @ odom_from_base
        scan = read_laser(self._robot)
        if self._base_from_laser is None:
            frame = self._robot.description.base_frame
            self._base_from_laser = self._frames.lookup(frame, scan.frame, scan.stamp)
        rays = Rays.from_scan(scan, self._base_from_laser)
        self._hits = rays.points()
        body.look(self._robot.state(), self._hits)
        if len(self.earlier):
            self._lay_earlier(pose, base_discs)
        self._costmap.see_laser(pose, rays)
        self._people.see(scan.stamp, odom_from_base, map_from_odom, rays)
        if depth and self._look_due(pose):
            self._see_depth(pose, float(self._base_from_laser.position[2]))
        self._costmap.refresh(pose)

    def near(self, map_from_odom: Pose2D) -> Array:
        """Points (n, 2) around the base that it must not meet, base frame, m.

        They are hits of the newest scan, what pictures showed beside it, and where people will be.
        """
        odom_from_base = self._odom_from_base()
        hits = np.vstack([self._hits, self._overlooked.near(odom_from_base, guard.NEAR)])
        if not len(self._costmap.movers):
            return hits
        return np.vstack([hits, self._people.expected(map_from_odom @ odom_from_base)])

    def _odom_from_base(self) -> Pose2D:
        return Pose2D.from_transform(self._robot.state().odom_from_base)

    def _lay_earlier(self, pose: Pose2D, base_discs: Array) -> None:
        """Mark the low things that earlier pictures showed; none lies where the base stands."""
        there, self.earlier = self.earlier, np.zeros((0, 2))
        own = pose.inverse().apply(there)
        off = np.linalg.norm(own[:, None] - base_discs[:, :2], axis=2)
        under = (off < base_discs[:, 2] + UNDER).any(axis=1)
        self._costmap.lay(there[~under])
        self._costmap.refresh()

    def _look_due(self, pose: Pose2D) -> bool:
        if not self.pictures:
            return False
        looked = self._costmap.looked
        if looked is None:
            return True
        turned = abs((looked.inverse() @ pose).yaw)
        way = looked.distance_to(pose) / self._config.depth_every
        return way + turned / TURN_BETWEEN_LOOKS > 1.0

    def _see_depth(self, pose: Pose2D, laser: float) -> None:
        """Add a depth picture; laser: the height of the laser's plane, m."""
        image = read_camera(self._robot)
        state = self._robot.state()
        obstacles, floor = obstacles_and_floor(
            image, self._frames, self._robot.description, state, self._scene, self._config
        )
        self._overlooked.see(self._odom_from_base(), obstacles, floor, self._hits)
        there = np.column_stack([pose.apply(obstacles), obstacles[:, 2]])
        self._costmap.see_depth(there, pose.apply(floor), laser - LASER_DOUBT)
        self._costmap.looked = pose
        shown = np.hypot(*np.vstack([obstacles[:, :2], floor]).T)
        self.blind = float(np.quantile(shown, FEW)) if len(shown) else self.blind
        self._scene.low_things = self._costmap.low_things()

"""Watching on the way: what the camera shows while the base drives over a growing map."""

from __future__ import annotations

import math

from momantu_bt.failure import SENSOR_DEAD
from momantu_bt.frames import MAP, ODOM
from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.robot import CameraSensor, Robot
from momantu_bt.service import PlanningScene, Snapshot
from momantu_bt.skill import Failure, Skill
from momantu_skills.mapping import coverage
from momantu_skills.mapping.own import Mapping
from momantu_skills.perception.camera import pictures
from momantu_skills.perception.camera.snapshot import take
from momantu_skills.perception.geometry import regions
from momantu_skills.perception.surface import tops

LOWEST, HIGHEST = 0.3, 1.1
"""Heights between which level tops are noted, m."""
WAY, TURN = 0.5, 0.5
"""Way, m, and turn, rad, of the camera between two pictures."""
UP, DOWN = math.radians(10.0), math.radians(-60.0)
"""Elevations between which a camera sees the tops of tables around."""


class Watch:
    """Notes the tops of tables that the camera shows by the way, and where it looked."""

    def __init__(self, skill: Skill, robot: Robot, mapping: Mapping, scene: PlanningScene) -> None:
        self._skill, self._robot = skill, robot
        self._mapping, self._scene = mapping, scene
        sensors = robot.description.sensors.values()
        self._sees = any(isinstance(sensor, CameraSensor) for sensor in sensors)
        self._last: Pose2D | None = None

    def look(self) -> None:
        """Take a picture if the camera has moved since the last one; it may be dead for a time."""
        if not self._sees:
            return
        here = _over_floor(
            self._skill.frames.lookup(ODOM, self._robot.description.camera()[1].frame)
        )
        if self._last is not None:
            turned = abs((self._last.inverse() @ here).yaw)
            if self._last.distance_to(here) < WAY and turned < TURN:
                return
        try:
            snapshot = take(self._robot, self._skill.frames)
        except Failure as failure:
            if failure.code != SENSOR_DEAD:
                raise
            return
        self._last = here
        self.note([snapshot])

    def note(self, snapshots: list[Snapshot]) -> None:
        """Remember where pictures were taken from one place, and the tops that they show."""
        notes, views = self._mapping.sightings, []
        map_from_odom = self._skill.frames.lookup(MAP, ODOM)
        for snapshot in snapshots:
            camera = map_from_odom @ snapshot.odom_from_camera
            if not DOWN < math.asin(float(camera.rotation[2, 2])) < UP:
                continue
            notes.looks.append(_over_floor(camera))
            around = regions.disc(snapshot.odom_from_camera.position[:2], coverage.SIGHT)
            region = regions.Region(around, LOWEST, HIGHEST)
            views.append(pictures.see(snapshot, region, self._scene, stride=1))
        if views:
            found = tops.tops_in(views, map_from_odom, LOWEST, HIGHEST)
            notes.note(found, self._skill.site.surfaces.values())


def _over_floor(frame_from_camera: Transform) -> Pose2D:
    """Where a camera is over the floor, and where its axis points."""
    x, y = (float(v) for v in frame_from_camera.position[:2])
    axis = frame_from_camera.rotation[:, 2]
    return Pose2D(x, y, math.atan2(float(axis[1]), float(axis[0])))

"""relocalize: find out where the robot is, by turning, driving and comparing with the map."""

from __future__ import annotations

import math
from collections.abc import Generator, Sequence
from typing import Any, ClassVar, TypeAlias

import numpy as np

from momantu_bt.activity import Activity
from momantu_bt.claim import Claim
from momantu_bt.descriptions.tunables import configured
from momantu_bt.failure import FailureValue
from momantu_bt.geometry import Array, Pose2D
from momantu_bt.lazy import lazily
from momantu_bt.messages import BaseVelocity
from momantu_bt.robot import CAMERA_CARRIER, Robot, read_laser
from momantu_bt.service import Localization, SeveralPlaces
from momantu_bt.skill import Failure, In, Needs, Run, Skill
from momantu_bt.symptom import Symptom
from momantu_skills.manipulation.scene.arm_scene import ArmScene
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.localize.confidence import estimate, is_localized, sigmas
from momantu_skills.navigation.map.sensing import Rays

with lazily():
    from momantu_skills.gaze import tucking
    from momantu_skills.navigation.control import footprint, guard, mppi
    from momantu_skills.navigation.drive import lost
    from momantu_skills.navigation.map import believed


WIDEN = (0.35, 0.35)
"""Initial standard deviations around the old estimate, m and rad: the largest drift that is
usual."""
SURE = 0.9
"""Scan fit (0 to 1) that a pose near the old estimate must reach; below it the whole map is
searched. A wrong corner of a room can reach 0.85."""
LOOK = 1.6
"""Time at rest that the localization service needs for its scans after a reset, s."""
FIRST_LOOK = 0.2
"""Time for the first scan of a search on the whole map, s."""
SETTLE = 0.5
"""Time at rest before a search is judged, s."""
NAMED = 4
"""Places that look alike which a failure names."""
TURNS = (math.radians(120.0), math.radians(360.0))
"""Angles to turn, rad: around the estimate, then after particles were spread over the map."""
RATE = 0.9
"""Speed of the turn, rad/s: slow enough for one scan every five degrees."""
BRAKE = 1.5
"""Planned deceleration, rad/s2."""
DONE = 0.03
"""Angle from its goal at which a turn ends, rad."""
PATIENCE = 1.0
"""Time to wait for an obstacle to clear a turn, s, before turning the other way."""


Found: TypeAlias = Generator[Any, Any, bool]


class Relocalize(Skill):
    """Localize the robot again: near the estimate first, then anywhere on the map.

    First the particles are spread around the estimate and the robot turns to both sides. If the
    scans still do not fit, the whole map is searched and the robot turns a full circle. Where
    several places look alike, it drives to where they would look different, by what its sensors
    see. It rather says that it does not know than name one of two places.
    """

    everywhere: bool = In(False, doc="start with the whole map")
    search_time: float = In(
        30.0, unit="s", least=0, most=600, doc="how long it may turn and drive on the whole map"
    )

    also_called: ClassVar = ("localize", "reset_localization", "initialize_pose")
    failures: ClassVar = {
        "NOT_LOCALIZED": "no place on the map, or more than one, fits what the laser sees",
        "ARM_STUCK": "the arm that carries the camera is stretched out and does not fold",
    }
    uses: ClassVar = {"base", CAMERA_CARRIER}
    activities: ClassVar = {Activity.LOCALIZE: ""}
    symptoms: ClassVar = {
        "NOT_LOCALIZED": {Symptom.NOT_LOCALIZED},
        "ARM_STUCK": {Symptom.ARM_OFF_COURSE, Symptom.SLOW},
    }

    localization: Localization = Needs()
    planning_scene: ArmScene = Needs()

    def run(self, robot: Robot) -> Run:
        """Search locally, then globally; judge each search at rest."""
        if robot.description.eye_in_hand:
            yield from tucking.take_in(self, robot, self.planning_scene)
        if not self.everywhere and (yield from self._near(robot)):
            return
        if (yield from self._anywhere(robot)):
            return
        position, yaw = sigmas(self.localization.covariance)
        places = self._places()
        raise Failure(
            "NOT_LOCALIZED",
            f"after turning round the newest scan fits the map by {self.localization.quality:.2f}, "
            f"and the robot may be anywhere within {position:.2f} m and {yaw:.2f} rad"
            + (f": {len(places)} places on the map look alike" if len(places) > 1 else ""),
            quality=self.localization.quality,
            sigma_position=position,
            sigma_yaw=yaw,
            places=[[place.x, place.y, place.yaw] for place in places[:NAMED]],
        )

    def _near(self, robot: Robot) -> Found:
        """Search around the estimate; judge at rest."""
        self.localization.reset(self.localization.map_from_base, *WIDEN)
        yield from self._rest(robot, LOOK)
        if is_localized(self.localization, SURE):
            return True
        yield from self._turn(robot, TURNS[0])
        yield from self._rest(robot, 0.5)
        return is_localized(self.localization, SURE)

    def _anywhere(self, robot: Robot) -> Found:
        """Search the whole map: turn round, then drive while several places look alike."""
        end = self.clock.now() + self.search_time - SETTLE
        self.localization.spread()
        yield from self._rest(robot, FIRST_LOOK)
        yield from self._turn(robot, TURNS[1])
        yield from self._rest(robot, SETTLE)
        if is_localized(self.localization):
            return True
        if self.site.map_file is None:
            return False
        config = configured(NavigationConfig, self.site.services.get("navigate", {}), "navigate")
        vehicle = lost.Lost(self, robot, self.localization, self.planning_scene, config)
        controller = mppi.Mppi(robot.description.base, vehicle.config, self.random)
        grid, been = believed.believed_maps(self.site)[0], [vehicle.pose()]

        def done() -> bool:
            return self.clock.now() > end or is_localized(self.localization)

        while not done():
            drive = lost.look_elsewhere(vehicle, controller, grid, self._places, been, done)
            if not (yield from drive):
                break
        yield from self._rest(robot, SETTLE)
        return is_localized(self.localization)

    def _places(self) -> Sequence[Pose2D]:
        """Where the robot may be, likeliest first, as far as the localization tells."""
        told = self.localization
        return told.places if isinstance(told, SeveralPlaces) else ()

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim that the base is at its estimated pose; NOT_LOCALIZED denies it."""
        if failure is not None and failure.code != "NOT_LOCALIZED":
            return None
        return None if self.site.map_file is None else estimate(self.localization)

    def _rest(self, robot: Robot, seconds: float) -> Run:
        end = self.clock.now() + seconds - 1e-6
        while self.clock.now() < end:
            robot.command("base", BaseVelocity(0.0, 0.0))
            yield "look"

    def _turn(self, robot: Robot, angle: float) -> Run:
        """Turn by odometry as far as the newest scan allows, then the other way.

        The time is limited, as an obstacle may not go away.
        """
        discs = self._discs(robot)
        end = self.clock.now() + 2.0 * angle / RATE
        for way in (1.0, -1.0):
            if (yield from self._turn_to(robot, angle, way, discs, end)):
                return

    def _turn_to(
        self, robot: Robot, angle: float, way: float, discs: Array, end: float
    ) -> Generator[str, None, bool]:
        """Turn one way; False if an obstacle stopped the turn, True if its angle or time did."""
        before, turned = robot.state().odom_from_base.yaw, 0.0
        free = self.clock.now()
        while angle - turned > DONE and self.clock.now() < end:
            rate = way * min(RATE, math.sqrt(2.0 * BRAKE * (angle - turned)))
            share = self._share(robot, rate, discs)
            free = self.clock.now() if share else free
            if self.clock.now() - free > PATIENCE:
                return False
            robot.command("base", BaseVelocity(0.0, rate * share))
            yield "turn"
            yaw = robot.state().odom_from_base.yaw
            turned += way * ((yaw - before + math.pi) % (2.0 * math.pi) - math.pi)
            before = yaw
        return True

    def _discs(self, robot: Robot) -> Array:
        """Return discs (m, 3) of base, arm and load: walls in a scan may be as high as these."""
        return footprint.discs(np.asarray(self.planning_scene.footprint(robot.state())))

    def _share(self, robot: Robot, rate: float, discs: Array) -> float:
        scan = read_laser(robot)
        base = robot.description.base_frame
        rays = Rays.from_scan(scan, self.frames.lookup(base, scan.frame, scan.stamp))
        state = robot.state()
        speed = (state.linear, state.angular, state.lateral)
        return guard.safe_share(
            (0.0, rate, 0.0), speed, robot.description.base, discs, rays.points()
        )

"""Spin, BackUp, DriveOnHeading, Wait: Nav2's simple behaviours, which its trees recover with."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar

from momantu_bt.activity import Activity
from momantu_bt.geometry import Pose2D, wrap_angle
from momantu_bt.robot import Robot
from momantu_bt.skill import Failure, In, Run
from momantu_bt.symptom import Symptom
from momantu_skills.nav2.action import Nav2Action
from momantu_skills.navigation.drive.vehicle import Vehicle

SPIN_SPEED = 1.0
"""Nav2's default turning speed, rad/s."""
BRAKE = 0.5
"""Share of the base's deceleration that is planned with."""
CREEP = 0.03
"""Lowest speed before the end of a motion, m/s and rad/s."""
DONE = 0.01
"""Distance or angle from its end at which a motion ends, m and rad."""
LOOK = 0.1
"""Distance between the poses that are checked ahead, m."""
AHEAD = 0.3
"""Distance that is checked ahead of a straight drive, m."""

_STOPPED = {Symptom.WAY_BLOCKED, Symptom.NOT_LOCALIZED}
_TIME = "longest time, by the world's clock"
_CHECKS = "true: ignore the costmap; the laser still stops the base"


class _Motion(Nav2Action):
    """A simple motion, measured by odometry."""

    failures: ClassVar = {
        "TIMEOUT": "the time allowance is over",
        "COLLISION_AHEAD": "something is in the way of the motion",
    }
    uses: ClassVar = {"base"}
    activities: ClassVar = {Activity.DRIVE: ""}
    symptoms: ClassVar = {
        "TIMEOUT": {Symptom.WAY_BLOCKED, Symptom.SLOW},
        "COLLISION_AHEAD": _STOPPED,
    }

    time_allowance: float = In(10.0, unit="s", least=0, doc=_TIME)
    disable_collision_checks: bool = In(False, doc=_CHECKS)

    def check_time(self, begun: float, left: str) -> None:
        """Raise TIMEOUT when the allowance is over. left: what remains, in words."""
        if self.clock.now() - begun > self.time_allowance:
            raise Failure("TIMEOUT", f"after {self.time_allowance:g} s {left} are left")

    def check_laser(self, vehicle: Vehicle) -> None:
        """Raise COLLISION_AHEAD when the laser has stopped the base for too long."""
        if vehicle.blocked_for > 1.0:
            raise Failure("COLLISION_AHEAD", "the laser sees something in the way")

    def cancelled(self, before: int) -> bool:
        """Whether a tree has cancelled the motion since it began."""
        return self.nav2.cancels(type(self).__name__) != before

    def straight(self, robot: Robot, distance: float, speed: float) -> Run:
        """Drive `distance` m straight on, negative: back, at `speed` m/s."""
        vehicle, begun = self.vehicle(robot), self.clock.now()
        before = self.nav2.cancels(type(self).__name__)
        start = vehicle.odom_from_base()
        way = math.copysign(1.0, distance)
        brake = BRAKE * vehicle.limits.linear_acceleration
        while True:
            left = abs(distance) - way * (start.inverse() @ vehicle.odom_from_base()).x
            if left < DONE or self.cancelled(before):
                break
            self.check_time(begun, f"{left:.2f} m")
            vehicle.sense(depth=False)
            self._check_straight(vehicle, way * min(left, AHEAD))
            fastest = min(speed, max(math.sqrt(2.0 * brake * left), CREEP))
            yield from vehicle.drive(way * fastest, 0.0, "drive")
            self.check_laser(vehicle)
        yield from vehicle.stop("stop")

    def _check_straight(self, vehicle: Vehicle, distance: float) -> None:
        if self.disable_collision_checks:
            return
        pose = vehicle.pose()
        least = min(vehicle.config.margin, vehicle.room(pose, whole=True) - 1e-3)
        for k in range(1, math.ceil(abs(distance) / LOOK) + 1):
            at = pose @ Pose2D(math.copysign(min(k * LOOK, abs(distance)), distance), 0.0, 0.0)
            if vehicle.room(at, whole=True) < least:
                side = "ahead" if distance > 0.0 else "behind"
                raise Failure("COLLISION_AHEAD", f"{k * LOOK:.1f} m {side} there is no room")


class Spin(_Motion):
    """Turn on the spot by an angle."""

    spin_dist: float = In(1.57, unit="rad", doc="how far, positive to the left")
    is_recovery: bool = In(True, ignored=True, doc="Nav2 counts recoveries")

    numbers: ClassVar = {"UNKNOWN": 700, "TIMEOUT": 701, "COLLISION_AHEAD": 703}

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """A short turn."""
        return {"inputs": {"spin_dist": 0.5}}

    def act(self, robot: Robot) -> Run:
        """Turn by odometry."""
        vehicle, begun = self.vehicle(robot), self.clock.now()
        cancels = self.nav2.cancels("Spin")
        way, turned = math.copysign(1.0, self.spin_dist), 0.0
        before = vehicle.odom_from_base().yaw
        fastest = min(SPIN_SPEED, vehicle.limits.angular)
        brake = BRAKE * vehicle.limits.angular_acceleration
        while (left := abs(self.spin_dist) - turned) > DONE and not self.cancelled(cancels):
            self.check_time(begun, f"{left:.2f} rad")
            vehicle.sense(depth=False)
            self._check_turn(vehicle, way * min(left, 0.5))
            rate = min(fastest, max(math.sqrt(2.0 * brake * left), 2.0 * CREEP))
            yield from vehicle.drive(0.0, way * rate, "turn")
            self.check_laser(vehicle)
            yaw = vehicle.odom_from_base().yaw
            turned += way * wrap_angle(yaw - before)
            before = yaw
        yield from vehicle.stop("stop")

    def _check_turn(self, vehicle: Vehicle, angle: float) -> None:
        if self.disable_collision_checks:
            return
        pose = vehicle.pose()
        least = min(0.0, vehicle.room(pose, whole=True) - 1e-3)
        for share in (0.5, 1.0):
            turned = pose @ Pose2D(0.0, 0.0, share * angle)
            if vehicle.room(turned, whole=True) < least:
                raise Failure("COLLISION_AHEAD", "there is no room to turn on the spot")


class BackUp(_Motion):
    """Drive straight back by a distance."""

    backup_dist: float = In(0.15, unit="m", least=0, doc="how far back")
    backup_speed: float = In(0.025, unit="m/s", least=0, doc="how fast")

    also_called: ClassVar = ("reverse", "drive_back", "move_back")
    failures: ClassVar = {**_Motion.failures, "INVALID_INPUT": "the speed is 0"}
    numbers: ClassVar = {
        "UNKNOWN": 710,
        "TIMEOUT": 711,
        "INVALID_INPUT": 713,
        "COLLISION_AHEAD": 714,
    }

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """A short way back."""
        return {"inputs": {"backup_dist": 0.15, "backup_speed": 0.15}}

    def act(self, robot: Robot) -> Run:
        """Drive back."""
        if self.backup_speed == 0.0 and self.backup_dist > 0.0:
            raise Failure("INVALID_INPUT", "backup_speed is 0; it must be above 0")
        yield from self.straight(robot, -self.backup_dist, self.backup_speed)


class DriveOnHeading(_Motion):
    """Drive straight on, or back where distance and speed are negative."""

    dist_to_travel: float = In(0.15, unit="m", doc="how far; negative: back")
    speed: float = In(0.025, unit="m/s", doc="how fast; negative: back")

    failures: ClassVar = {
        **_Motion.failures,
        "INVALID_INPUT": "distance and speed have different signs, or the speed is 0",
    }
    numbers: ClassVar = {
        "UNKNOWN": 720,
        "TIMEOUT": 721,
        "COLLISION_AHEAD": 723,
        "INVALID_INPUT": 724,
    }

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """A short way ahead."""
        return {"inputs": {"dist_to_travel": 0.3, "speed": 0.2}}

    def act(self, robot: Robot) -> Run:
        """Drive."""
        if self.dist_to_travel * self.speed < 0.0 or self.speed == 0.0:
            raise Failure(
                "INVALID_INPUT",
                f"dist_to_travel {self.dist_to_travel:g} m and speed {self.speed:g} m/s must have "
                "the same sign, and a speed",
            )
        yield from self.straight(robot, self.dist_to_travel, abs(self.speed))


class Wait(Nav2Action):
    """Wait for a time of the world's clock."""

    wait_duration: float = In(1.0, unit="s", least=0, doc="how long")

    numbers: ClassVar = {"UNKNOWN": 740}

    def act(self, robot: Robot) -> Run:
        """Wait, until the time is over or a tree cancels it."""
        end, before = self.clock.now() + self.wait_duration - 1e-6, self.nav2.cancels("Wait")
        while self.clock.now() < end and self.nav2.cancels("Wait") == before:
            yield "wait"

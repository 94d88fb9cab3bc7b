"""teleop_base: a person drives the base; the laser and the costmap stop it before obstacles."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar

from momantu_bt.activity import Activity
from momantu_bt.descriptions.tunables import configured
from momantu_bt.geometry import Pose2D
from momantu_bt.robot import BaseLimits, Robot
from momantu_bt.service import Localization
from momantu_bt.skill import Needs, Run, Skill
from momantu_bt.teleoperation import Command, Operator
from momantu_skills.controls import OPERATED, commanded, rehearsed
from momantu_skills.manipulation.scene.service import PlanningSceneService
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.drive.body import BodyScene
from momantu_skills.navigation.drive.vehicle import Speed, Vehicle
from momantu_skills.navigation.localize.service import LocalizationService

SHARES = (1.0, 0.75, 0.5, 0.25)
"""Shares of a command that are tried, the fastest first."""
REACTION = 0.2
"""Time that a command stays in effect before braking begins, s, as the laser's guard has it."""
STEP = 0.1
"""Time step of the prediction, s."""
NEARER = 1e-3
"""A base that has no room may go on as long as the room does not shrink by more than this, m."""


class TeleopBase(Skill):
    """Drive the base as a person commands, until the person leaves.

    It goes slower, or stops, where it could not brake before an obstacle: one in the laser's newest
    scan, or one in the costmap, which knows of the map and of what the laser saw before.
    """

    failures = {**OPERATED}
    uses: ClassVar = {"base"}
    activities: ClassVar = {Activity.DRIVE: ""}
    symptoms: ClassVar = {}
    operator: Operator = Needs()
    localization: Localization = Needs()
    planning_scene: BodyScene = Needs()

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """A short drive ahead."""
        services = rehearsed(lambda now: Command(now, linear=0.3, angular=0.2))
        scene, belief = PlanningSceneService(), LocalizationService()
        return {"services": {**services, "localization": belief, "planning_scene": scene}}

    def run(self, robot: Robot) -> Run:
        """Drive a control period at a time."""
        limits = robot.description.base
        vehicle: Vehicle | None = None
        while not (command := commanded(self)).ended:
            linear, angular, lateral = speeds = _within(limits, command)
            if vehicle is None and not any(speeds):
                yield "standing"
                continue
            vehicle = vehicle or self._vehicle(robot)
            share, phase = _share(vehicle, speeds)
            yield from vehicle.drive(share * linear, share * angular, phase, share * lateral)
        if vehicle is not None:
            yield from vehicle.stop("stopping")

    def _vehicle(self, robot: Robot) -> Vehicle:
        parameters = self.site.services.get("navigate", {})
        config = configured(NavigationConfig, parameters, "navigate")
        return Vehicle(self, robot, self.localization, self.planning_scene, config, gazes=False)


def _within(limits: BaseLimits, command: Command) -> Speed:
    """The commanded speeds, or the base's greatest."""
    wanted = (command.linear, command.angular, command.lateral)
    most = (limits.linear, limits.angular, limits.sideways)
    linear, angular, lateral = (max(-m, min(m, w)) for w, m in zip(wanted, most, strict=True))
    return linear, angular, lateral


def _share(vehicle: Vehicle, speeds: Speed) -> tuple[float, str]:
    """The share of a command that is safe, and the phase that says why it is less than 1."""
    if not any(speeds):
        return 1.0, "standing"
    vehicle.sense(depth=False)
    seen = vehicle.allowed(*speeds)
    known = next((s for s in SHARES if _has_room(vehicle, *(s * v for v in speeds))), 0.0)
    if min(seen, known) == 1.0:
        return 1.0, "driving"
    where = "the laser sees it" if seen <= known else "in the map or an earlier scan"
    verb = "stopped" if min(seen, known) == 0.0 else "slowed"
    return min(seen, known), f"{verb}: obstacle, {where}"


def _has_room(vehicle: Vehicle, linear: float, angular: float, lateral: float) -> bool:
    """Whether base, arm and load stay clear of the costmap until the base has braked."""
    pose, limits, after = vehicle.pose(), vehicle.limits, 0.0
    least = min(0.0, vehicle.room(pose, whole=True) - NEARER)
    while linear != 0.0 or angular != 0.0 or lateral != 0.0:
        pose = pose @ Pose2D(linear * STEP, lateral * STEP, angular * STEP)
        if vehicle.room(pose, whole=True) < least:
            return False
        after += STEP
        if after >= REACTION:
            linear = _slower(linear, limits.linear_acceleration * STEP)
            angular = _slower(angular, limits.angular_acceleration * STEP)
            lateral = _slower(lateral, limits.linear_acceleration * STEP)
    return True


def _slower(speed: float, change: float) -> float:
    return math.copysign(max(0.0, abs(speed) - change), speed)

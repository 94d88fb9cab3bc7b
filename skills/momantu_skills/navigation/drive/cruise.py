"""Cruising: drive from where the base is to where the approach begins."""

from __future__ import annotations

import math
from collections.abc import Generator
from typing import Any

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose2D, wrap_angle
from momantu_bt.skill import Compute, compute
from momantu_skills.navigation.control.mppi import Mppi
from momantu_skills.navigation.drive.manoeuvre import approach_is_sure
from momantu_skills.navigation.drive.moves import back_off, can_turn, clear_behind, turn_to
from momantu_skills.navigation.drive.route import Route, no_way, route_to
from momantu_skills.navigation.drive.vehicle import Vehicle

REPLAN = 2.0
"""Time between plans, s, even if nothing blocks the path: unknown parts of the map come into
view."""
TURN_FIRST = 0.9
"""Angle to the path above which a base at rest turns on the spot first, rad."""
NEAR = 0.25
"""Distance from the lead-in, in weighted metres, at which cruising ends."""
APPROACH_FROM = 2.0
"""Distance from the goal pose within which the approach is simulated, m."""
GLIDE_FROM = 0.8
"""The same for a base that glides there, which goes slowly sideways, m."""
DETOURS = 8
"""Replans to a longer path before the base is reported to drive in circles."""
UNMAPPED_DETOURS = 40
"""The same without a map, where every closed door is a surprise."""
LONGEST_BACK = 0.8
"""Longest distance that the base backs up from a table to free its arm, m."""
SNUG = 0.1
"""Clearance beside the base up to which a place that it does not get through is too narrow, m."""
PROGRESS = 0.1
"""Decrease of the remaining distance that counts as progress, in weighted metres."""

Drive = Generator[str | Compute, Any, None]


def leave(vehicle: Vehicle, heading: float) -> Drive:
    """Back up until arm and load are free and the base can turn to `heading`."""
    pose = vehicle.pose()

    def free(at: Pose2D) -> bool:
        turn = abs(wrap_angle(heading - at.yaw)) > TURN_FIRST
        return vehicle.room(at, whole=True) > 0.0 and (not turn or can_turn(vehicle, at, heading))

    for distance in np.arange(0.0, LONGEST_BACK + 0.01, 0.1):
        at = pose @ Pose2D(-float(distance), 0.0, 0.0)
        if not clear_behind(vehicle, pose, float(distance)):
            return
        if free(at):
            if distance > 0.0:
                yield from back_off(vehicle, float(distance), "leave")
            return


def cruise(vehicle: Vehicle, mppi: Mppi, route: Route, distance: float) -> Drive:
    """Drive until a simulated approach to the route's goal pose ends within `distance` m of it.

    Ends at the lead-in at the latest. Raises PATH_BLOCKED or NO_PROGRESS.
    """
    watch = _Watch(vehicle, route)
    mppi.restart()
    while True:
        vehicle.sense()
        pose = vehicle.pose()
        near = pose.distance_to(route.stand) < (GLIDE_FROM if vehicle.glides else APPROACH_FROM)
        if near and approach_is_sure(vehicle, route.stand, distance):
            return
        if route.to_go(pose) < NEAR:
            return
        if watch.replan_due(route, pose):
            route = yield from _replanned(vehicle, route, watch)
            continue
        watch.check(route, pose)
        off = wrap_angle(route.heading(pose) - pose.yaw)
        turn_first = abs(off) > TURN_FIRST and abs(vehicle.speed()[0]) < 0.1
        if turn_first and (yield from turn_to(vehicle, pose.yaw + off, "turn to the path")):
            mppi.restart()
            continue
        linear, angular, lateral = mppi.command(
            pose, vehicle.speed(), vehicle.costmap, vehicle.discs, route.plan
        )
        yield from vehicle.drive(linear, angular, "drive", lateral)


def _replanned(vehicle: Vehicle, route: Route, watch: _Watch) -> Generator[Any, Any, Route]:
    def work() -> Route | None:
        vehicle.costmap.refresh()
        return route_to(vehicle, route.stand)

    found = yield from compute(work, vehicle.config.planning_time)
    if found is None:
        yield from vehicle.stop("blocked")
        yield from vehicle.wait(0.5, "blocked")
        vehicle.sense()
        found = yield from compute(work, vehicle.config.planning_time)
    if found is None:
        raise no_way(vehicle, route.stand)
    watch.planned(found)
    return found


class _Watch:
    """Timers: when to plan again, and when the base has stopped making progress."""

    def __init__(self, vehicle: Vehicle, route: Route) -> None:
        self._vehicle = vehicle
        self._detours = 0
        self._best = math.inf
        self._best_at = self._planned_at = vehicle.now()
        self.planned(route)

    def planned(self, route: Route) -> None:
        """Take over a new plan; count a longer path as a detour."""
        self._planned_at = self._vehicle.now()
        self._vehicle.show(route.plan.path)
        to_go = route.to_go(self._vehicle.pose())
        if to_go > self._best + 1.0:
            self._detours += 1
            self._best, self._best_at = to_go, self._vehicle.now()
        if self._detours > (DETOURS if self._vehicle.mapped else UNMAPPED_DETOURS):
            raise Failure(
                "NO_PROGRESS", f"{self._detours} detours did not lead past what is in the way"
            )

    def replan_due(self, route: Route, pose: Pose2D) -> bool:
        """Return whether the plan is old, or an obstacle has appeared on its path."""
        if not route.plan.fits(self._vehicle.costmap.grid):
            return True
        age = self._vehicle.now() - self._planned_at
        if age > REPLAN:
            return True
        return age > 0.4 and route.crossed(self._vehicle, pose)

    def check(self, route: Route, pose: Pose2D) -> None:
        """Raise NO_PROGRESS if the remaining distance has not fallen for too long.

        Plans of this vehicle then avoid a narrow point ahead if there is another way.
        """
        vehicle, now, to_go = self._vehicle, self._vehicle.now(), route.to_go(pose)
        if to_go < self._best - PROGRESS:
            self._best, self._best_at = to_go, now
        if now - self._best_at > vehicle.config.patience:
            x, y, room = route.narrowest(vehicle, pose)
            if room < vehicle.half_width + SNUG:
                vehicle.caution.avoid(x, y)
                why = f"at ({x:.2f}, {y:.2f}) its way is about {2 * room:.2f} m wide"
            else:
                why = "its way is wide enough: something may hold its wheels, or stand beside them"
            raise Failure(
                "NO_PROGRESS",
                f"the base, {2 * vehicle.half_width:.2f} m wide, got no nearer for "
                f"{vehicle.config.patience:.0f} s; {why}",
                at=[x, y],
                to_go=to_go,
                blocked=vehicle.blocked_total,
            )

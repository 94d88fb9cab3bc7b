"""Following a path that may be replaced at any moment, around what stands on it."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from typing import Any

from momantu_bt.failure import Failure
from momantu_bt.geometry import Path, Pose2D, wrap_angle
from momantu_bt.skill import Compute, compute
from momantu_skills.navigation.control.mppi import Mppi
from momantu_skills.navigation.drive.arrive import arrive, within
from momantu_skills.navigation.drive.cruise import APPROACH_FROM, TURN_FIRST, leave
from momantu_skills.navigation.drive.manoeuvre import approach_is_sure, prepare
from momantu_skills.navigation.drive.moves import turn_to
from momantu_skills.navigation.drive.route import planned, planning_radius
from momantu_skills.navigation.drive.track import Track
from momantu_skills.navigation.drive.vehicle import Vehicle
from momantu_skills.navigation.plan.planner import Plan

WINDOW = 1.2
"""Length of the path ahead that the controller is given, m: with more it cuts corners."""
BEYOND = 1.5
"""How far beyond an obstacle on the window's end the base may aim, m."""
RENEW = 0.4
"""The window moves on after this many metres, or twice as many seconds."""
STRAIGHT = 1.05
"""The rest of the path counts as straight, so that the approach does not cut a corner, while it is
at most this many times as long as the way to its end."""
NEAR_END = 0.3
"""Length of the rest of the path at which following ends, m."""
NEVER = (0.0, -math.inf)
"""Where on the track, m, and when, s, the window was planned last: it is due now."""
PROGRESS = 0.5
"""Distance that the base must have moved, m, or turned, rad, within the patience for progress."""

Drive = Generator[str | Compute, Any, None]


class Follower:
    """Follows `path_now()`, which is read in each control period.

    tolerance: m and rad, at the path's end. told: called in each period with the track and the
    base's pose.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        mppi: Mppi,
        path_now: Callable[[], Path],
        tolerance: tuple[float, float],
        told: Callable[[Track, Pose2D], None],
    ) -> None:
        self._vehicle, self._mppi, self._path_now = vehicle, mppi, path_now
        self._tolerance, self._told = tolerance, told
        self._track = Track(path_now(), vehicle.pose())
        self._plan: Plan | None = None
        self._planned = NEVER
        self._free_at = vehicle.now()
        self._moved = (vehicle.pose(), vehicle.now())

    def follow(self) -> Drive:
        """Drive until the base stands at the path's end.

        Raises:
            Failure: NO_PROGRESS, NO_WAY or BLOCKED.
        """
        vehicle = self._vehicle
        yield from leave(vehicle, self._track.heading(vehicle.pose()))
        self._mppi.restart()
        while True:
            vehicle.sense()
            pose = self._look()
            if self._ends(pose):
                if (yield from self._arrive()):
                    return
                self._plan = None
                continue
            self._check_progress(pose)
            if self._window_is_due():
                yield from self._renew()
                continue
            if self._plan is None:
                yield from self._wait_for_a_way()
                continue
            yield from self._drive(pose)

    def _look(self) -> Pose2D:
        """Take over a new path, find the base on it, and report."""
        pose, path = self._vehicle.pose(), self._path_now()
        if path is not self._track.path:
            if path != self._track.path:
                self._track, self._planned = Track(path, pose), NEVER
            else:
                self._track.path = path
        self._report(pose)
        return pose

    def _report(self, pose: Pose2D) -> None:
        self._track.advance(pose)
        self._told(self._track, pose)

    def _ends(self, pose: Pose2D) -> bool:
        track, distance = self._track, self._tolerance[0]
        rest = track.to_go + pose.distance_to(track.path[track.at])
        if rest < NEAR_END:
            return True
        straight = pose.distance_to(track.end)
        if rest > APPROACH_FROM or rest > STRAIGHT * straight + track.spacing:
            return False
        return approach_is_sure(self._vehicle, track.end, distance)

    def _arrive(self) -> Generator[str | Compute, Any, bool]:
        """Reach the path's end; False when the path came to end elsewhere meanwhile."""
        vehicle, end = self._vehicle, self._track.end
        distance, angle = self._tolerance
        if not approach_is_sure(vehicle, end, distance):
            yield from vehicle.stop("line up")
            if within(vehicle.pose(), end, distance, angle):
                return True
            yield from prepare(vehicle, end, distance)
        approach = arrive(vehicle, lambda: end, distance, angle)
        answer: Any = None
        while True:
            try:
                said = approach.send(answer)
            except StopIteration as stop:
                if not stop.value:
                    raise Failure(
                        "NO_PROGRESS", "there is no room to approach the end of the path"
                    ) from None
                return True
            answer = yield said
            self._report(vehicle.pose())
            if not within(self._path_now()[-1], end, distance, angle):
                approach.close()
                self._mppi.restart()
                return False

    def _window_is_due(self) -> bool:
        at, when = self._planned
        moved_on = self._track.along[self._track.at] - at > RENEW
        return moved_on or self._vehicle.now() - when > 2.0 * RENEW

    def _renew(self) -> Drive:
        work = self._window
        self._plan = yield from compute(work, self._vehicle.config.planning_time)
        self._planned = (self._track.along[self._track.at], self._vehicle.now())
        if self._plan is not None:
            self._free_at = self._vehicle.now()

    def _window(self) -> Plan | None:
        """The way to the end of the next part of the path, or past what stands there."""
        track, vehicle = self._track, self._vehicle
        last = track.window(WINDOW)
        beyond = last
        while beyond + 1 < len(track.path) and track.along[beyond] - track.along[last] < BEYOND:
            beyond += 1
        candidates = [*range(last, beyond + 1), *range(last - 1, track.at, -1)]
        target = next((k for k in candidates if self._is_free(track.path[k])), None)
        if target is None:
            return None
        weight = track.corridor(vehicle.costmap, target)
        return planned(vehicle, track.path[target], weight=weight)

    def _is_free(self, pose: Pose2D) -> bool:
        costmap = self._vehicle.costmap
        if not costmap.grid.contains(pose.x, pose.y):
            return False
        row, column = costmap.grid.index(pose.x, pose.y)
        least = planning_radius(self._vehicle) - self._vehicle.config.planner.tight_by
        return bool(costmap.field[row, column] > least)

    def _wait_for_a_way(self) -> Drive:
        vehicle = self._vehicle
        if vehicle.now() - self._free_at > vehicle.config.blocked_patience:
            raise Failure(
                "NO_WAY",
                f"for {vehicle.config.blocked_patience:.0f} s no way led on along the path",
            )
        yield from vehicle.stop("blocked")
        yield from vehicle.wait(vehicle.config.period, "blocked")

    def _check_progress(self, pose: Pose2D) -> None:
        before, since = self._moved
        now, patience = self._vehicle.now(), self._vehicle.config.patience
        turned = abs((before.inverse() @ pose).yaw)
        if pose.distance_to(before) > PROGRESS or turned > PROGRESS:
            self._moved = (pose, now)
        elif now - since > patience:
            raise Failure(
                "NO_PROGRESS", f"the base has moved less than {PROGRESS} m for {patience:.0f} s"
            )
        if self._vehicle.blocked_for > self._vehicle.config.blocked_patience:
            raise Failure(
                "BLOCKED",
                f"the laser has kept the base from moving for {self._vehicle.blocked_for:.0f} s",
            )

    def _drive(self, pose: Pose2D) -> Drive:
        vehicle, track = self._vehicle, self._track
        off = wrap_angle(track.heading(pose) - pose.yaw)
        turn_first = abs(off) > TURN_FIRST and abs(vehicle.speed()[0]) < 0.1
        if turn_first and (yield from turn_to(vehicle, pose.yaw + off, "turn to the path")):
            self._mppi.restart()
            return
        assert self._plan is not None
        linear, angular, lateral = self._mppi.command(
            pose, vehicle.speed(), vehicle.costmap, vehicle.discs, self._plan
        )
        yield from vehicle.drive(linear, angular, "drive", lateral)

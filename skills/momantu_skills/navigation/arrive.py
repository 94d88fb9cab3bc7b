"""The last metre: to a stand, within tolerance, and corrections when it was missed."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose2D
from momantu_skills.navigation import approach
from momantu_skills.navigation.moves import Move, back_off, clear_behind, creep, turn_to
from momantu_skills.navigation.vehicle import Vehicle

CORRECTIONS = 4
"""Manoeuvres at the goal before it counts as unreachable to that accuracy."""
AIM = 0.5
"""Share of the tolerance that an approach must promise, so that noise does not spoil it."""
TURN_AT_END = 0.35
"""rad that may be left to a turn on the spot at the goal."""
LOCAL = 1.6
"""m from the goal within which it is reached by manoeuvres instead of by a planned way."""
SETTLE = 0.35
"""s at rest before the pose is judged: three scans."""


def within(pose: Pose2D, goal: Pose2D, distance: float, angle: float) -> bool:
    """Whether a pose meets a goal's tolerances, m and rad."""
    return pose.distance_to(goal) <= distance and abs((goal.inverse() @ pose).yaw) <= angle


def retreat_needed(vehicle: Vehicle, goal: Pose2D, distance: float) -> float | None:
    """m to back up, from where the approach would succeed: 0 at once; None when none serves."""
    pose = vehicle.pose()
    margin = min(vehicle.config.margin, vehicle.room(goal, whole=False) - 0.005)
    for back in np.arange(0.0, 1.3, 0.15):
        if back > 0.0 and not clear_behind(vehicle, pose, float(back)):
            return None
        start = pose @ Pose2D(-float(back), 0.0, 0.0)
        speed = vehicle.speed() if back == 0.0 else (0.0, 0.0)
        end = approach.simulate(
            start, speed, goal, vehicle.limits, vehicle.costmap, vehicle.base_discs
        )
        if end.within(distance * AIM, TURN_AT_END, margin):
            return float(back)
    return None


def arrive(vehicle: Vehicle, goal: Callable[[], Pose2D], distance: float, angle: float) -> Move:
    """Reach `goal()` (map) within m and rad. False when no approach from here would.

    Raises:
        Failure: NO_PROGRESS when the corrections are used up.
    """
    for _ in range(CORRECTIONS):
        yield from _run_in(vehicle, goal)
        yield from vehicle.stop("settle")
        yield from _square_up(vehicle, goal, angle)
        yield from vehicle.wait(SETTLE, "settle")
        if within(vehicle.pose(), goal(), distance, angle):
            return True
        if (yield from _nudge(vehicle, goal(), distance, angle)):
            yield from vehicle.wait(SETTLE, "settle")
            if within(vehicle.pose(), goal(), distance, angle):
                return True
        vehicle.sense()
        back = retreat_needed(vehicle, goal(), distance)
        if back is None:
            return False
        if back > 0.0:
            yield from back_off(vehicle, back)
    left = goal().inverse() @ vehicle.pose()
    raise Failure(
        "NO_PROGRESS",
        f"{CORRECTIONS} corrections left the base {math.hypot(left.x, left.y) * 1000:.0f} mm and "
        f"{math.degrees(left.yaw):.1f} degrees from the goal",
        ahead=left.x,
        left=left.y,
        yaw=left.yaw,
    )


def _run_in(vehicle: Vehicle, goal: Callable[[], Pose2D]) -> Move:
    deadline = vehicle.now() + approach.LONGEST
    while vehicle.now() < deadline:
        vehicle.sense()
        wanted = approach.command(vehicle.pose(), goal(), vehicle.limits)
        if wanted is None:
            return True
        yield from vehicle.drive(*wanted, "approach")
        if vehicle.blocked_for > vehicle.config.blocked_patience:
            raise Failure(
                "PATH_BLOCKED",
                "something stands between the base and its goal",
                to_go=vehicle.pose().distance_to(goal()),
            )
    return False


def _square_up(vehicle: Vehicle, goal: Callable[[], Pose2D], angle: float) -> Move:
    if abs((vehicle.pose().inverse() @ goal()).yaw) < 0.5 * angle:
        return True
    return (yield from turn_to(vehicle, goal().yaw, "square up"))


def _nudge(vehicle: Vehicle, goal: Pose2D, distance: float, angle: float) -> Move:
    """Straight and turning corrections, which serve when the base is not beside its goal."""
    off = goal.inverse() @ vehicle.pose()
    if abs(off.y) > 0.9 * distance:
        return False
    if abs(off.x) > 0.5 * distance:
        yield from creep(vehicle, goal)
    if abs((goal.inverse() @ vehicle.pose()).yaw) > 0.5 * angle:
        yield from turn_to(vehicle, goal.yaw, "square up")
    return True

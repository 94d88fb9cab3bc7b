"""Arriving: reach the goal pose within its tolerance, and correct remaining errors."""

from __future__ import annotations

import math
from collections.abc import Callable

from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose2D
from momantu_skills.navigation.drive.manoeuvre import prepare, run_in
from momantu_skills.navigation.drive.moves import Move, creep, turn_to
from momantu_skills.navigation.drive.vehicle import Vehicle

CORRECTIONS = 4
"""Corrections at the goal before it counts as unreachable with that accuracy."""
SETTLE = 0.35
"""Time at rest before the pose is checked, s: three scans."""


def within(pose: Pose2D, goal: Pose2D, distance: float, angle: float) -> bool:
    """Return whether a pose is within a goal's tolerances, m and rad."""
    return pose.distance_to(goal) <= distance and abs((goal.inverse() @ pose).yaw) <= angle


def arrive(vehicle: Vehicle, goal: Callable[[], Pose2D], distance: float, angle: float) -> Move:
    """Reach `goal()` (map) within m and rad; False if no approach from here would succeed.

    Raises:
        Failure: NO_PROGRESS when the corrections are used up.
    """
    for _ in range(CORRECTIONS):
        yield from run_in(vehicle, goal)
        yield from vehicle.stop("settle")
        yield from _square_up(vehicle, goal, angle)
        yield from vehicle.wait(SETTLE, "settle")
        if within(vehicle.pose(), goal(), distance, angle):
            return True
        if (yield from _nudge(vehicle, goal(), distance, angle)):
            yield from vehicle.wait(SETTLE, "settle")
            if within(vehicle.pose(), goal(), distance, angle):
                return True
        if not (yield from prepare(vehicle, goal(), distance)):
            return False
    left = goal().inverse() @ vehicle.pose()
    raise Failure(
        "NO_PROGRESS",
        f"{CORRECTIONS} corrections left the base {math.hypot(left.x, left.y) * 1000:.0f} mm and "
        f"{math.degrees(left.yaw):.1f} degrees from the goal",
        ahead=left.x,
        left=left.y,
        yaw=left.yaw,
    )


def _square_up(vehicle: Vehicle, goal: Callable[[], Pose2D], angle: float) -> Move:
    if abs((vehicle.pose().inverse() @ goal()).yaw) < 0.5 * angle:
        return True
    return (yield from turn_to(vehicle, goal().yaw, "square up"))


def _nudge(vehicle: Vehicle, goal: Pose2D, distance: float, angle: float) -> Move:
    """Correct by driving straight and turning, which works if the goal is not to the side."""
    off = goal.inverse() @ vehicle.pose()
    if abs(off.y) > 0.9 * distance:
        return False
    if abs(off.x) > 0.5 * distance:
        yield from creep(vehicle, goal)
    if abs((goal.inverse() @ vehicle.pose()).yaw) > 0.5 * angle:
        yield from turn_to(vehicle, goal.yaw, "square up")
    return True

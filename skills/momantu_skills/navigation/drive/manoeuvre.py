"""Short manoeuvres to a nearby pose: the approach itself, or the moves that prepare it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose2D, wrap_angle
from momantu_skills.navigation.control import glide, graceful
from momantu_skills.navigation.drive.moves import Move, back_off, can_turn, clear_behind, turn_to
from momantu_skills.navigation.drive.vehicle import Speed, Vehicle

AIM = 0.5
"""Share of the tolerance that a simulated approach must meet, as a reserve for noise."""
TURN_AT_END = 0.35
"""Heading error at the goal that a turn on the spot may correct, rad."""
BACKS = 0.15
"""Distance between the back-up distances that are tried, m."""
FARTHEST_BACK = 1.2
"""Largest distance to back up, m."""
HOP = 1.3
"""Longest straight drive between two turns on the spot, m."""
TURN_TIME = 1.0
"""Average turning speed, rad/s, for comparing manoeuvres."""
DRIVE_TIME = 0.4
"""Average speed of a short straight drive, m/s."""
BACK_SPEED = 0.25
"""Average speed when backing up, m/s."""
SWITCH = 0.5
"""Time lost at each change of direction, s."""


def prepare(vehicle: Vehicle, goal: Pose2D, distance: float) -> Move:
    """Prepare the base so that `run_in` reaches a goal (map) within `distance` m.

    If the goal lies straight behind, the base backs up to it. Otherwise the quickest of these is
    chosen: nothing, backing up, or turning towards the goal, driving there and turning again.
    Returns False if there is no room for any of them.
    """
    vehicle.sense()
    behind = straight_behind(vehicle, goal, distance)
    if behind is not None:
        return (yield from back_off(vehicle, behind))
    retreat = quickest_retreat(vehicle, goal, distance)
    bearing = hop_bearing(vehicle, goal)
    if bearing is not None and (
        retreat is None or _hop_time(vehicle, goal, bearing) < retreat.seconds
    ):
        return (yield from _hop(vehicle, goal, bearing))
    if retreat is None or retreat.back == 0.0:
        return retreat is not None
    return (yield from back_off(vehicle, retreat.back))


def straight_behind(vehicle: Vehicle, goal: Pose2D, distance: float) -> float | None:
    """Return how far behind the base the goal lies, m, if backing up reaches it, else None."""
    here = vehicle.pose().inverse() @ goal
    aligned = abs(here.y) < AIM * distance and abs(here.yaw) < TURN_AT_END
    if not (aligned and -FARTHEST_BACK < here.x < -AIM * distance):
        return None
    return -here.x if clear_behind(vehicle, vehicle.pose(), -here.x) else None


@dataclass(frozen=True, slots=True)
class Retreat:
    """How far to back up before the approach, m (0: not at all); seconds: time for both."""

    back: float
    seconds: float


def approach_is_sure(vehicle: Vehicle, goal: Pose2D, distance: float) -> bool:
    """Return whether a simulated `run_in` ends within `distance` m, with clearance all the way."""
    return _arrival(vehicle, vehicle.pose(), vehicle.speed(), goal).within(
        distance * AIM, TURN_AT_END, _margin(vehicle, goal)
    )


def quickest_retreat(vehicle: Vehicle, goal: Pose2D, distance: float) -> Retreat | None:
    """Return the quickest back-up and approach, including 0 m; None if there is no room."""
    pose, best = vehicle.pose(), None
    for back in (float(b) for b in np.arange(0.0, FARTHEST_BACK + 0.01, BACKS)):
        if back > 0.0 and not clear_behind(vehicle, pose, back):
            break
        start = pose @ Pose2D(-back, 0.0, 0.0)
        speed = vehicle.speed() if back == 0.0 else (0.0, 0.0, 0.0)
        end = _arrival(vehicle, start, speed, goal)
        seconds = end.seconds + (back / BACK_SPEED + SWITCH if back else 0.0)
        sure = end.within(distance * AIM, TURN_AT_END, _margin(vehicle, goal))
        if sure and (best is None or seconds < best.seconds):
            best = Retreat(back, seconds)
    return best


def _arrival(vehicle: Vehicle, pose: Pose2D, speed: Speed, goal: Pose2D) -> graceful.Arrival:
    law = glide.simulate if vehicle.glides else graceful.simulate
    low = law(pose, speed, goal, vehicle.limits, vehicle.costmap, vehicle.low_discs)
    if not vehicle.reaches_over:
        return low
    high = law(pose, speed, goal, vehicle.limits, vehicle.tall, vehicle.discs)
    return replace(low, room=min(low.room, high.room))


def _margin(vehicle: Vehicle, goal: Pose2D) -> float:
    """Return the clearance of an approach: the goal itself may have less than the usual margin."""
    return min(vehicle.config.margin, vehicle.room(goal, whole=False) - 0.005)


def hop_bearing(vehicle: Vehicle, goal: Pose2D) -> float | None:
    """Return the direction to the goal (map, rad) if drive and turns have room, else None."""
    pose = vehicle.pose()
    way = pose.distance_to(goal)
    if not 0.02 < way < HOP:
        return None
    bearing = math.atan2(goal.y - pose.y, goal.x - pose.x)
    there = Pose2D(goal.x, goal.y, bearing)
    if not (can_turn(vehicle, pose, bearing) and can_turn(vehicle, there, goal.yaw)):
        return None
    steps = (
        Pose2D(pose.x, pose.y, bearing) @ Pose2D(float(d), 0.0, 0.0)
        for d in np.arange(0, way, 0.05)
    )
    least = min(0.0, vehicle.room(pose, whole=True), vehicle.room(goal, whole=True))
    return bearing if all(vehicle.room(step, whole=True) >= least for step in steps) else None


def _hop_time(vehicle: Vehicle, goal: Pose2D, bearing: float) -> float:
    pose = vehicle.pose()
    turns = abs(wrap_angle(bearing - pose.yaw)) + abs(wrap_angle(goal.yaw - bearing))
    return 2.0 * SWITCH + turns / TURN_TIME + pose.distance_to(goal) / DRIVE_TIME


def _hop(vehicle: Vehicle, goal: Pose2D, bearing: float) -> Move:
    there = Pose2D(goal.x, goal.y, bearing)
    if not (yield from turn_to(vehicle, bearing, "turn to the goal")):
        return False
    if not (yield from run_in(vehicle, lambda: there)):
        return False
    yield from vehicle.stop("settle")
    return (yield from turn_to(vehicle, goal.yaw, "square up"))


def run_in(vehicle: Vehicle, goal: Callable[[], Pose2D]) -> Move:
    """Follow the approach to `goal()` (map); True at its end, False when time or room runs out.

    Raises:
        Failure: PATH_BLOCKED when something stands in the way.
    """
    deadline = vehicle.now() + graceful.LONGEST
    while vehicle.now() < deadline:
        vehicle.sense()
        wanted = _towards(vehicle, goal())
        if wanted is None:
            return True
        if vehicle.glides and not _stays_clear(vehicle, goal()):
            return False
        linear, angular, lateral = wanted
        yield from vehicle.drive(linear, angular, "approach", lateral)
        if vehicle.blocked_for > vehicle.config.blocked_patience:
            raise Failure(
                "PATH_BLOCKED",
                "something stands between the base and its goal",
                to_go=vehicle.pose().distance_to(goal()),
            )
    return False


def _towards(vehicle: Vehicle, goal: Pose2D) -> Speed | None:
    if vehicle.glides:
        return glide.command(vehicle.pose(), goal, vehicle.limits)
    wanted = graceful.command(vehicle.pose(), goal, vehicle.limits)
    return None if wanted is None else (*wanted, 0.0)


def _stays_clear(vehicle: Vehicle, goal: Pose2D) -> bool:
    """Whether what was seen leaves room to the goal: no laser looks where a base glides to."""
    pose = vehicle.pose()
    least = min(_margin(vehicle, goal), vehicle.room(pose, whole=False) - 0.005)
    return _arrival(vehicle, pose, vehicle.speed(), goal).room > min(0.0, least)

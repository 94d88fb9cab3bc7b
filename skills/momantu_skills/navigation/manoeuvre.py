"""Getting into a pose nearby: the approach itself, or what must be done before it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose2D, wrap_angle
from momantu_skills.navigation import approach
from momantu_skills.navigation.moves import Move, back_off, can_turn, clear_behind, turn_to
from momantu_skills.navigation.vehicle import Vehicle

AIM = 0.5
"""Share of the tolerance that an approach must promise, so that noise does not spoil it."""
TURN_AT_END = 0.35
"""rad that may be left to a turn on the spot at the goal."""
BACKS = 0.15
"""m between the retreats that are tried."""
FARTHEST_BACK = 1.2
"""m of retreat at most."""
HOP = 1.2
"""m that are driven straight between two turns on the spot, at most."""
TURN_TIME = 1.0
"""rad/s on average over a turn, for comparing manoeuvres."""
DRIVE_TIME = 0.4
"""m/s on average over a short straight."""
BACK_TIME = 0.2
"""m/s on average backwards, to and fro counted together."""


def prepare(vehicle: Vehicle, goal: Pose2D, distance: float) -> Move:
    """Do what makes a goal (map) reachable by `run_in` within `distance` m.

    Nothing, a retreat, or turning towards the goal, driving there and turning again, whichever
    is quickest; False when none has room.
    """
    vehicle.sense()
    back = retreat_needed(vehicle, goal, distance)
    if back == 0.0:
        return True
    bearing = hop_bearing(vehicle, goal)
    if bearing is not None and (
        back is None or _hop_time(vehicle, goal, bearing) < back / BACK_TIME
    ):
        return (yield from _hop(vehicle, goal, bearing))
    return False if back is None else (yield from back_off(vehicle, back))


def retreat_needed(vehicle: Vehicle, goal: Pose2D, distance: float) -> float | None:
    """How far to back up for the approach to succeed, m: 0 at once; None when nothing serves."""
    pose = vehicle.pose()
    margin = min(vehicle.config.margin, vehicle.room(goal, whole=False) - 0.005)
    for back in np.arange(0.0, FARTHEST_BACK + 0.01, BACKS):
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


def hop_bearing(vehicle: Vehicle, goal: Pose2D) -> float | None:
    """Direction to the goal (map, rad) when the way there and both turns have room, else None."""
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
    return turns / TURN_TIME + pose.distance_to(goal) / DRIVE_TIME


def _hop(vehicle: Vehicle, goal: Pose2D, bearing: float) -> Move:
    there = Pose2D(goal.x, goal.y, bearing)
    if not (yield from turn_to(vehicle, bearing, "turn to the goal")):
        return False
    if not (yield from run_in(vehicle, lambda: there)):
        return False
    yield from vehicle.stop("settle")
    return (yield from turn_to(vehicle, goal.yaw, "square up"))


def run_in(vehicle: Vehicle, goal: Callable[[], Pose2D]) -> Move:
    """Follow the approach to `goal()` (map); True at its line, False when time is up.

    Raises:
        Failure: PATH_BLOCKED when something stands in the way.
    """
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

"""Simple moves: turn on the spot, back up, creep. Each move returns whether it succeeded."""

from __future__ import annotations

import math
from collections.abc import Generator
from typing import Any

from momantu_bt.geometry import Pose2D, wrap_angle
from momantu_bt.skill import Compute
from momantu_skills.navigation.drive.vehicle import Vehicle

Move = Generator[str | Compute, Any, bool]
"""A move: yields phases and returns whether it reached its goal."""

TURN_BRAKE = 0.6
"""Share of the base's angular deceleration that turns use."""
TURN_DONE = 0.015
"""Angle from its goal at which a turn ends, rad: a third of the usual tolerance."""
TURN_LEAST = 0.06
"""Lowest turning speed, rad/s: slow enough to stop within `TURN_DONE`, fast enough to keep
moving."""
BACK_SPEED = 0.3
"""Speed backwards, m/s; no laser covers the space behind."""
CREEP_BRAKE = 0.4
"""Planned deceleration, m/s2."""
CREEP_DONE = 0.01
"""Distance from its goal at which creeping ends, m."""
BACK_STEP = 0.1
"""Distance between the positions that are checked behind the base, m."""
SWEEP = 9
"""Headings that are checked for a turn: every 20 degrees of a half turn."""
STALL = 3.0
"""A move is aborted after twice the time that it needs plus this, s."""


def turn_to(vehicle: Vehicle, yaw: float, phase: str = "turn") -> Move:
    """Turn on the spot to a heading in the map; False if an obstacle is in the way."""
    gap = abs(wrap_angle(yaw - vehicle.pose().yaw))
    fastest = vehicle.limits.angular
    brake = TURN_BRAKE * vehicle.limits.angular_acceleration
    deadline = vehicle.now() + 2.0 * gap / fastest + STALL
    while vehicle.now() < deadline:
        error = wrap_angle(yaw - vehicle.pose().yaw)
        if abs(error) < TURN_DONE:
            yield from vehicle.stop(phase)
            return True
        rate = min(fastest, math.sqrt(2.0 * brake * abs(error)), 4.0 * abs(error))
        vehicle.sense(depth=False)
        yield from vehicle.drive(0.0, math.copysign(max(rate, TURN_LEAST), error), phase)
        if vehicle.blocked_for > vehicle.config.blocked_patience:
            break
    yield from vehicle.stop(phase)
    return False


def can_turn(vehicle: Vehicle, pose: Pose2D, yaw: float) -> bool:
    """Return whether arm and load stay clear when the base turns from `pose` to `yaw`."""
    turn = wrap_angle(yaw - pose.yaw)
    steps = max(1, math.ceil(SWEEP * abs(turn) / math.pi))
    headings = (pose.yaw + turn * (k + 1) / steps for k in range(steps))
    return all(vehicle.room(Pose2D(pose.x, pose.y, h), whole=True) > 0.0 for h in headings)


def back_off(vehicle: Vehicle, distance: float, phase: str = "back off") -> Move:
    """Drive straight back; False if the costmap shows no room before the end of the distance."""
    start = vehicle.odom_from_base()
    deadline = vehicle.now() + 2.0 * distance / BACK_SPEED + STALL
    while vehicle.now() < deadline:
        gone = start.distance_to(vehicle.odom_from_base())
        if gone > distance - CREEP_DONE:
            yield from vehicle.stop(phase)
            return True
        vehicle.sense(depth=False)
        if not clear_behind(vehicle, vehicle.pose(), 0.12):
            break
        left = distance - gone
        speed = min(BACK_SPEED, math.sqrt(2.0 * CREEP_BRAKE * left), 1.5 * left + 0.03)
        yield from vehicle.drive(-speed, 0.0, phase)
        if vehicle.blocked_for > vehicle.config.blocked_patience:
            break
    yield from vehicle.stop(phase)
    return False


def creep(vehicle: Vehicle, target: Pose2D, phase: str = "creep") -> Move:
    """Drive straight until level with a pose in the map that lies ahead or behind."""
    deadline = vehicle.now() + STALL + 20.0 * abs(_ahead(vehicle, target))
    while vehicle.now() < deadline:
        left = _ahead(vehicle, target)
        if abs(left) < CREEP_DONE:
            yield from vehicle.stop(phase)
            return True
        vehicle.sense(depth=False)
        if left < 0.0 and not clear_behind(vehicle, vehicle.pose(), min(-left, 0.12)):
            break
        speed = min(0.2, math.sqrt(2.0 * CREEP_BRAKE * abs(left)), 1.5 * abs(left) + 0.01)
        yield from vehicle.drive(math.copysign(speed, left), 0.0, phase)
        if vehicle.blocked_for > vehicle.config.blocked_patience:
            break
    yield from vehicle.stop(phase)
    return False


def clear_behind(vehicle: Vehicle, pose: Pose2D, distance: float) -> bool:
    """Return whether the base (with its load) can back up that far, or at least gets no nearer."""
    steps = max(1, math.ceil(distance / BACK_STEP))
    for whole in (False, True):
        least = min(vehicle.config.margin, vehicle.room(pose, whole=whole) - 1e-3)
        for k in range(steps):
            behind = pose @ Pose2D(-distance * (k + 1) / steps, 0.0, 0.0)
            if vehicle.room(behind, whole=whole) < least:
                return False
    return True


def _ahead(vehicle: Vehicle, target: Pose2D) -> float:
    return (vehicle.pose().inverse() @ target).x

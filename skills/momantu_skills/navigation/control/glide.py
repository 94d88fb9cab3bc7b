"""Gliding: the last metre of an omnidirectional base, straight to a pose while it turns."""

from __future__ import annotations

import math

import numba
import numpy as np

from momantu_bt.geometry import Array, Pose2D, wrap_angle
from momantu_bt.robot import BaseLimits
from momantu_skills.navigation.control.graceful import (
    ARRIVED,
    BRAKE,
    CREEP,
    EASE,
    LONGEST,
    STEP,
    TOP_SPEED,
    Arrival,
)
from momantu_skills.navigation.map.costmap import Costmap, room
from momantu_skills.navigation.map.fields import Field
from momantu_skills.navigation.map.heights import Tall

SIDE_SPEED = 0.3
"""Top speed sideways and backwards, m/s: a laser that looks ahead may not see what is there."""
TURN_BRAKE = 0.6
"""Share of the base's angular deceleration that turns use."""
TURN_EASE = 2.0
"""Turning speed per remaining angle, 1/s; commands are late by one scan."""
FACED = 0.02
"""Heading error below which the base stops turning, rad."""


def sideways(limits: BaseLimits) -> float:
    """Speed at which the base may drive to either side, m/s; 0: it does not go there."""
    return min(limits.sideways, SIDE_SPEED)


def command(pose: Pose2D, goal: Pose2D, limits: BaseLimits) -> tuple[float, float, float] | None:
    """Return the next (m/s ahead, rad/s, m/s to the left) towards the goal; None at the goal."""
    left = pose.inverse() @ goal
    v, w, u = _law(left.x, left.y, wrap_angle(left.yaw), _bounds(limits))
    return None if (v, w, u) == (0.0, 0.0, 0.0) else (float(v), float(w), float(u))


def simulate(
    pose: Pose2D,
    speed: tuple[float, float, float],
    goal: Pose2D,
    limits: BaseLimits,
    costmap: Costmap | Tall,
    discs: Array,
) -> Arrival:
    """Simulate the way from a pose at a measured speed, with its least clearance."""
    here = goal.inverse() @ pose
    start = np.array([here.x, here.y, wrap_angle(here.yaw), *speed], dtype=np.float64)
    end = np.array([goal.x, goal.y, goal.yaw], dtype=np.float64)
    bounds = _bounds(limits)
    return Arrival(*_simulate(start, end, bounds, costmap.field, costmap.frame, discs))


def _bounds(limits: BaseLimits) -> Array:
    return np.array(
        [
            min(TOP_SPEED, limits.linear),
            min(SIDE_SPEED, limits.linear),
            sideways(limits),
            limits.angular,
            limits.linear_acceleration,
            limits.angular_acceleration,
        ]
    )


@numba.njit(cache=True)
def _law(ahead: float, left: float, turn: float, bounds: Array) -> tuple[float, float, float]:
    """Speeds towards a goal that lies there in the base's frame: ahead, rad/s, to the left."""
    distance = math.hypot(ahead, left)
    v = u = w = 0.0
    if distance >= ARRIVED:
        speed = min(bounds[0], math.sqrt(2.0 * BRAKE * distance), EASE * distance + CREEP)
        v = speed * ahead / distance
        u = speed * left / distance
        most = max(v / bounds[0], -v / bounds[1], abs(u) / bounds[2], 1.0)
        v /= most
        u /= most
    if abs(turn) >= FACED:
        brake = TURN_BRAKE * bounds[5]
        w = min(bounds[3], math.sqrt(2.0 * brake * abs(turn)), TURN_EASE * abs(turn) + CREEP)
        w = math.copysign(w, turn)
    return v, w, u


@numba.njit(cache=True)
def _simulate(
    start: Array, goal: Array, bounds: Array, field: Field, frame: Array, discs: Array
) -> tuple[float, float, float, float, float]:
    """As `graceful` has it. start: x, y, yaw in the goal's frame, then the speeds."""
    x, y, yaw, v, w, u = start[0], start[1], start[2], start[3], start[4], start[5]
    c, s = math.cos(goal[2]), math.sin(goal[2])
    least = 1e9
    for i in range(int(LONGEST / STEP)):
        cb, sb = math.cos(yaw), math.sin(yaw)
        turn = math.atan2(-sb, cb)
        to_v, to_w, to_u = _law(-cb * x - sb * y, sb * x - cb * y, turn, bounds)
        v += min(max(to_v - v, -bounds[4] * STEP), bounds[4] * STEP)
        u += min(max(to_u - u, -bounds[4] * STEP), bounds[4] * STEP)
        w += min(max(to_w - w, -bounds[5] * STEP), bounds[5] * STEP)
        yaw += 0.5 * w * STEP
        cb, sb = math.cos(yaw), math.sin(yaw)
        x += (v * cb - u * sb) * STEP
        y += (v * sb + u * cb) * STEP
        yaw += 0.5 * w * STEP
        there_x = goal[0] + c * x - s * y
        there_y = goal[1] + s * x + c * y
        least = min(least, room(field, frame, discs, there_x, there_y, goal[2] + yaw))
        stopping = to_v == 0.0 and to_w == 0.0 and to_u == 0.0
        if stopping and abs(v) < 1e-6 and abs(w) < 1e-6 and abs(u) < 1e-6:
            return x, y, math.atan2(math.sin(yaw), math.cos(yaw)), least, i * STEP
    return 1e9, 1e9, 1e9, least, LONGEST

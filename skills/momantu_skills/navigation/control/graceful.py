"""The graceful controller: a smooth law that brings a unicycle to a pose.

From Park and Kuipers, "A smooth control law for graceful motion", 2011.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np

from momantu_bt.geometry import Array, Pose2D
from momantu_bt.robot import BaseLimits
from momantu_skills.navigation.map.costmap import Costmap, room
from momantu_skills.navigation.map.fields import Field
from momantu_skills.navigation.map.heights import Tall

TURN_IN = 1.3
"""k1 of the paper: how strongly the heading turns towards the goal's axis."""
FOLLOW = 3.5
"""k2 of the paper: how fast the actual heading follows the wanted one."""
SLOW_IN_CURVES = 0.5
"""The speed is divided by 1 + this * curvature^2 (1/m)."""
TOP_SPEED = 0.95
"""Top speed on the approach, m/s: the last metre is driven slowly."""
CREEP = 0.06
"""Lowest speed, at the end of the approach, m/s."""
EASE = 1.8
"""Speed per metre of remaining distance near the goal, 1/s; commands are late by one scan."""
BRAKE = 0.5
"""Planned deceleration, m/s2: half of what the base can do."""
ARRIVED = 0.012
"""Distance before the goal's line at which the base stops, m; braking from `CREEP` covers the
rest."""
STEP = 0.1
"""Time step of the simulated approach, s."""
LONGEST = 12.0
"""Longest duration of an approach, s."""
CRAWL = 0.5 * CREEP
"""Lowest allowed speed of an approach, m/s. An approach that curves so much that it must be slower
is rejected: its duration depends on millimetres, so the simulation would not predict what
happens."""


@dataclass(frozen=True, slots=True)
class Arrival:
    """End of a simulated approach. ahead, left: error in the goal's frame, m. yaw: error, rad.

    room: least clearance on the way, m. seconds: duration. Errors are infinite if it does not
    arrive.
    """

    ahead: float
    left: float
    yaw: float
    room: float
    seconds: float

    def within(self, distance: float, angle: float, margin: float) -> bool:
        """Return whether it ends within tolerance of the goal and keeps the margin all the way."""
        return (
            math.hypot(self.ahead, self.left) < distance
            and abs(self.yaw) < angle
            and self.room > margin
        )


def command(pose: Pose2D, goal: Pose2D, limits: BaseLimits) -> tuple[float, float] | None:
    """Return the next (m/s, rad/s) towards the goal; None at the goal's line: stop there."""
    x, y, yaw = float(pose.x), float(pose.y), float(pose.yaw)
    goal_x, goal_y, goal_yaw = float(goal.x), float(goal.y), float(goal.yaw)
    v, w = _law(x, y, yaw, goal_x, goal_y, goal_yaw, limits.angular, _top(limits))
    return None if v == 0.0 else (float(v), float(w))


def simulate(
    pose: Pose2D,
    speed: tuple[float, float, float],
    goal: Pose2D,
    limits: BaseLimits,
    costmap: Costmap | Tall,
    discs: Array,
) -> Arrival:
    """Simulate the approach from a pose and a measured speed, with its least clearance.

    speed: m/s ahead, rad/s, and m/s to the left, which no unicycle has.
    """
    start = np.array([pose.x, pose.y, pose.yaw, *speed[:2]], dtype=np.float64)
    end = np.array([goal.x, goal.y, goal.yaw], dtype=np.float64)
    bounds = np.array(
        [
            limits.angular,
            limits.linear_acceleration,
            limits.angular_acceleration,
            _top(limits),
        ]
    )
    return Arrival(*_simulate(start, end, bounds, costmap.field, costmap.frame, discs))


def _top(limits: BaseLimits) -> float:
    """Return the top speed on the approach, m/s."""
    return min(TOP_SPEED, limits.linear)


@numba.njit(cache=True)
def _law(
    x: float,
    y: float,
    yaw: float,
    goal_x: float,
    goal_y: float,
    goal_yaw: float,
    fastest: float,
    top: float,
) -> tuple[float, float]:
    dx = goal_x - x
    dy = goal_y - y
    ahead = math.cos(goal_yaw) * dx + math.sin(goal_yaw) * dy
    distance = math.hypot(dx, dy)
    if ahead < ARRIVED or distance < ARRIVED:
        return 0.0, 0.0
    sight = math.atan2(dy, dx)
    theta = math.atan2(math.sin(goal_yaw - sight), math.cos(goal_yaw - sight))
    delta = math.atan2(math.sin(yaw - sight), math.cos(yaw - sight))
    pull = FOLLOW * (delta - math.atan(-TURN_IN * theta))
    pull += (1.0 + TURN_IN / (1.0 + (TURN_IN * theta) ** 2)) * math.sin(delta)
    curvature = -pull / max(distance, 0.15)
    v = top / (1.0 + SLOW_IN_CURVES * curvature * curvature)
    v = min(v, math.sqrt(2.0 * BRAKE * ahead), EASE * ahead + CREEP)
    if abs(v * curvature) > fastest:
        v = fastest / abs(curvature)
    return v, v * curvature


@numba.njit(cache=True)
def _simulate(
    start: Array, goal: Array, bounds: Array, field: Field, frame: Array, discs: Array
) -> tuple[float, float, float, float, float]:
    x, y, yaw, v, w = start[0], start[1], start[2], start[3], start[4]
    least = 1e9
    c = math.cos(goal[2])
    s = math.sin(goal[2])
    stopping = False
    for i in range(int(LONGEST / STEP)):
        if not stopping:
            to_v, to_w = _law(x, y, yaw, goal[0], goal[1], goal[2], bounds[0], bounds[3])
            stopping = to_v == 0.0
            if not stopping and to_v < CRAWL:
                break
        if stopping:
            to_v, to_w = 0.0, 0.0
        v += min(max(to_v - v, -bounds[1] * STEP), bounds[1] * STEP)
        w += min(max(to_w - w, -bounds[2] * STEP), bounds[2] * STEP)
        yaw += 0.5 * w * STEP
        x += v * math.cos(yaw) * STEP
        y += v * math.sin(yaw) * STEP
        yaw += 0.5 * w * STEP
        least = min(least, room(field, frame, discs, x, y, yaw))
        if stopping and v < 1e-6 and abs(w) < 1e-6:
            dx = x - goal[0]
            dy = y - goal[1]
            turn = math.atan2(math.sin(yaw - goal[2]), math.cos(yaw - goal[2]))
            return c * dx + s * dy, -s * dx + c * dy, turn, least, i * STEP
    return 1e9, 1e9, 1e9, least, LONGEST

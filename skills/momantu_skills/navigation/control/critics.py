"""The critics of the local controller: the cost of each step of a rollout, in metres.

Each critic is a function that is compiled into the rollout. Its weight is set in
`navigate.controller.weights`; the remaining distance to the goal has weight 1.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numba

DEEPEST = 0.3
"""Overlap with an obstacle above which the cost does not grow any more, m."""
DEPTH = 10.0
"""Cost per m of overlap."""
LEAST_SPEED = 0.1
"""Added to the speed at which the base passes an obstacle, m/s, so that standing next to one also
has a cost."""
COMPANY, COMPANY_DECAY = 4.0, 0.3
"""Cost of driving beside somebody who walks, per metre, and its decay with the distance, m."""
ON_THE_WAY = 0.3
"""Weight of the mean remaining distance along a rollout, relative to that at its end."""


class Critics(NamedTuple):
    """Weights of the critics, and the clearances and speeds that they require, m and m/s."""

    collision: float
    nearness: float
    haste: float
    heading: float
    smoothness: float
    margin: float
    comfort: float
    near_speed: float
    far_clearance: float


@numba.njit(cache=True, inline="always")
def collision(critics: Critics, spare: float, step: int, steps: int) -> float:
    """Cost of a collision at a step; spare: clearance, m, below 0. Early collisions cost more."""
    return critics.collision * (steps - step) / steps + DEPTH * min(-spare, DEEPEST)


@numba.njit(cache=True, inline="always")
def nearness(critics: Critics, spare: float, speed: float, dt: float) -> float:
    """Cost of being near an obstacle for `dt` s, times the speed there."""
    return critics.nearness * math.exp(-spare / critics.comfort) * (LEAST_SPEED + speed) * dt


@numba.njit(cache=True, inline="always")
def company(apart: float, speed: float, dt: float) -> float:
    """Cost of being `apart` m from somebody who walks, for `dt` s, times the speed there."""
    return COMPANY * math.exp(-apart / COMPANY_DECAY) * (LEAST_SPEED + speed) * dt


@numba.njit(cache=True, inline="always")
def haste(critics: Critics, spare: float, speed: float, top_speed: float, dt: float) -> float:
    """Cost of `dt` s above the allowed speed, which is `near_speed` with no clearance to spare."""
    share = min(spare / (critics.far_clearance - critics.margin), 1.0)
    allowed = critics.near_speed + share * (top_speed - critics.near_speed)
    return critics.haste * max(0.0, speed - allowed) ** 2 * dt


@numba.njit(cache=True, inline="always")
def smoothness(critics: Critics, turn: float, turn_before: float) -> float:
    """Cost of a change of the turning speed, rad/s."""
    return critics.smoothness * (turn - turn_before) ** 2


@numba.njit(cache=True, inline="always")
def progress(to_go: float, steps: int) -> float:
    """Cost of the remaining distance at one step, m; the distance at the end counts in full."""
    return ON_THE_WAY * to_go / steps


@numba.njit(cache=True, inline="always")
def heading(critics: Critics, yaw: float, dx: float, dy: float, steep: float) -> float:
    """Cost of heading away from the goal; (dx, dy): slope of the remaining distance."""
    return critics.heading * (1.0 + (math.cos(yaw) * dx + math.sin(yaw) * dy) / steep)

"""The critics of the local controller: what each step of a rollout costs, in metres still to go.

Each critic is a function that is compiled into the rollout, and has a weight in
`navigate.controller.weights`; the progress towards the goal itself weighs 1.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numba

DEEPEST = 0.3
"""m of overlap with something beyond which it gets no worse."""
DEPTH = 10.0
"""Cost per m of overlap."""
LEAST_SPEED = 0.1
"""m/s added to the speed at which something is passed: standing beside it costs, too."""
ON_THE_WAY = 0.3
"""Weight of the mean distance to go along a rollout, over that at its end."""


class Critics(NamedTuple):
    """Weights of the critics, and the room and speeds that they ask for, m and m/s."""

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
    """Cost of a collision at a step; spare: room left, m, below 0. The earlier, the worse."""
    return critics.collision * (steps - step) / steps + DEPTH * min(-spare, DEEPEST)


@numba.njit(cache=True, inline="always")
def nearness(critics: Critics, spare: float, speed: float, dt: float) -> float:
    """Cost of being near something for `dt` s, times the speed there."""
    return critics.nearness * math.exp(-spare / critics.comfort) * (LEAST_SPEED + speed) * dt


@numba.njit(cache=True, inline="always")
def haste(critics: Critics, spare: float, speed: float, top_speed: float, dt: float) -> float:
    """Cost of driving for `dt` s faster than allowed: `near_speed` with no room to spare."""
    share = min(spare / (critics.far_clearance - critics.margin), 1.0)
    allowed = critics.near_speed + share * (top_speed - critics.near_speed)
    return critics.haste * max(0.0, speed - allowed) ** 2 * dt


@numba.njit(cache=True, inline="always")
def smoothness(critics: Critics, turn: float, turn_before: float) -> float:
    """Cost of a change of the turning speed, rad/s."""
    return critics.smoothness * (turn - turn_before) ** 2


@numba.njit(cache=True, inline="always")
def progress(to_go: float, steps: int) -> float:
    """Cost of the distance to go at one step, m; the distance at the end counts in full."""
    return ON_THE_WAY * to_go / steps


@numba.njit(cache=True, inline="always")
def heading(critics: Critics, yaw: float, dx: float, dy: float, steep: float) -> float:
    """Cost of heading away from where the distance to go falls; (dx, dy): its slope."""
    return critics.heading * (1.0 + (math.cos(yaw) * dx + math.sin(yaw) * dy) / steep)

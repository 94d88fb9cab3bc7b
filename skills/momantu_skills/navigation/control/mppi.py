"""The local controller: model predictive path integral control (Williams et al. 2017)."""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Pose2D
from momantu_bt.robot import BaseLimits
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.control import critics, glide
from momantu_skills.navigation.map.costmap import Costmap, room
from momantu_skills.navigation.map.fields import Field, sample
from momantu_skills.navigation.map.movers import AHEAD, RADIUS
from momantu_skills.navigation.plan.planner import Plan

CLOSE = 0.3
"""Remaining distance below which the heading at the end of a rollout does not matter, m."""
SLOPE = 0.1
"""Offset to either side of a point for computing the slope of the remaining distance, m."""
FARTHEST, STEEPEST = 1e5, 100.0
"""Limits of the remaining distance, m, and of its change over 2 `SLOPE`; above them a cell counts
as having no path to the goal."""
SIDE_NOISE = 0.5
"""Standard deviation of the speeds sideways that are drawn, relative to the greatest one."""
DETOUR = 3.0
"""Largest distance that a rollout may seem to move away from the goal, m."""


class Mppi:
    """The controller: keeps the last control sequence and improves it at each call."""

    def __init__(
        self,
        limits: BaseLimits,
        navigation: NavigationConfig,
        random: np.random.Generator,
    ) -> None:
        sideways = glide.sideways(limits)
        self._config, self._period = navigation.controller, navigation.period
        self._random = random
        self._limits = np.array(
            [
                min(limits.linear, navigation.speed),
                limits.angular,
                limits.linear_acceleration,
                limits.angular_acceleration,
                sideways,
            ]
        )
        self._noise = np.array([self._config.speed_noise, self._config.turn_noise])
        if sideways > 0.0:
            self._noise = np.append(self._noise, SIDE_NOISE * sideways)
        c = self._config
        self._critics = critics.Critics(
            **c.weights.model_dump(),
            margin=navigation.margin,
            comfort=navigation.comfort,
            near_speed=navigation.near_speed,
            far_clearance=navigation.far_clearance,
        )
        at = np.linspace(0.0, c.knots - 1.0, c.steps)
        self._before = np.minimum(at.astype(np.int64), c.knots - 2)
        self._share = at - self._before
        self.restart()

    def restart(self) -> None:
        """Forget the last controls, because another controller has driven the base."""
        self._controls = np.zeros((self._config.steps, len(self._noise)))

    def command(
        self,
        pose: Pose2D,
        speed: tuple[float, float, float],
        costmap: Costmap,
        discs: Array,
        plan: Plan,
    ) -> tuple[float, float, float]:
        """Return the next speeds for a pose in the map and the measured speeds.

        Both are (m/s ahead, rad/s, m/s to the left).
        """
        c = self._config
        shift = max(1, round(self._period / c.step))
        self._controls = np.concatenate(
            [self._controls[shift:], self._controls[-1:].repeat(shift, 0)]
        )
        noise = self._random.standard_normal((c.samples, c.knots, len(self._noise)))
        noise *= self._noise
        limits = self._limits_at(pose, costmap, discs)
        controls = _controls(self._controls, noise, self._before, self._share, limits)
        start = np.array([pose.x, pose.y, pose.yaw, *speed])
        costs = _costs(
            start, controls, c.step, costmap.field, costmap.frame, discs, plan.cost, limits,
            self._critics, costmap.movers,
        )  # fmt: skip
        weights = np.exp((costs.min() - costs) / c.temperature)
        self._controls = np.einsum("s,stc->tc", weights / weights.sum(), controls)
        linear, angular, *lateral = map(float, self._controls[0])
        return linear, angular, lateral[0] if lateral else 0.0

    def _limits_at(self, pose: Pose2D, costmap: Costmap, discs: Array) -> Array:
        """The limits here: less speed near and in slow zones."""
        if not costmap.zones.slow:
            return self._limits
        limits = self._limits.copy()
        limits[0] = min(limits[0], costmap.zones.limit(pose, discs, float(limits[2])))
        return limits


@numba.njit(cache=True)
def _controls(
    last: Array, noise: Array, before: NDArray[np.int64], share: Array, limits: Array
) -> Array:
    """Control sequences (samples, steps, 2 or 3) around the `last` (steps, 2 or 3), in the limits.

    noise: (samples, knots, 2 or 3). before, share (steps,): the knot before each step, and the
    share of the next one. Three sequences are the last one, standing still, and full speed ahead.
    """
    kinds = last.shape[1]
    controls = np.empty((noise.shape[0], last.shape[0], kinds))
    for s in range(controls.shape[0]):
        for t in range(controls.shape[1]):
            k = before[t]
            for c in range(kinds):
                shift = (1.0 - share[t]) * noise[s, k, c] + share[t] * noise[s, k + 1, c]
                controls[s, t, c] = last[t, c] + shift
    controls[0] = last
    controls[1] = 0.0
    controls[2] = 0.0
    controls[2, :, 0] = limits[0]
    for s in range(controls.shape[0]):
        for t in range(controls.shape[1]):
            controls[s, t, 0] = min(max(controls[s, t, 0], 0.0), limits[0])
            controls[s, t, 1] = min(max(controls[s, t, 1], -limits[1]), limits[1])
            if kinds == 3:
                controls[s, t, 2] = min(max(controls[s, t, 2], -limits[4]), limits[4])
    return controls


@numba.njit(cache=True)
def _costs(
    start: Array,
    controls: Array,
    dt: float,
    field: Field,
    frame: Array,
    discs: Array,
    cost_to_go: Field,
    limits: Array,
    weights: critics.Critics,
    movers: Array,
) -> Array:
    costs = np.empty(controls.shape[0])
    for i in range(controls.shape[0]):
        costs[i] = _cost(
            start, controls[i], dt, field, frame, discs, cost_to_go, limits, weights, movers
        )
    return costs


@numba.njit(cache=True)
def _cost(
    start: Array,
    controls: Array,
    dt: float,
    field: Field,
    frame: Array,
    discs: Array,
    cost_to_go: Field,
    limits: Array,
    weights: critics.Critics,
    movers: Array,
) -> float:
    """Simulate a rollout within acceleration limits; return its `critics`' sum.

    A rollout ends at its first collision.
    """
    x, y, yaw, v, w, u = start[0], start[1], start[2], start[3], start[4], start[5]
    steps, kinds = controls.shape
    total = 0.0
    here = min(_to_go(cost_to_go, frame, x, y), FARTHEST)
    last = here
    worst = here + DETOUR
    for t in range(steps):
        before = w
        v += min(max(controls[t, 0] - v, -limits[2] * dt), limits[2] * dt)
        w += min(max(controls[t, 1] - w, -limits[3] * dt), limits[3] * dt)
        speed = v
        yaw += 0.5 * w * dt
        x += v * math.cos(yaw) * dt
        y += v * math.sin(yaw) * dt
        if kinds == 3:
            u += min(max(controls[t, 2] - u, -limits[2] * dt), limits[2] * dt)
            x -= u * math.sin(yaw) * dt
            y += u * math.cos(yaw) * dt
            speed = math.hypot(v, u)
        yaw += 0.5 * w * dt
        spare = room(field, frame, discs, x, y, yaw) - weights.margin
        last = min(_to_go(cost_to_go, frame, x, y), worst)
        if spare < 0.0:
            total += critics.collision(weights, spare, t, steps)
            break
        if movers.shape[0] > 0:
            apart = _from_movers(movers, (t + 1) * dt, discs, x, y, yaw) - weights.margin
            if apart < 0.0:
                total += critics.collision(weights, apart, t, steps)
                break
            total += critics.company(apart, speed, dt)
        total += critics.nearness(weights, spare, speed, dt)
        total += critics.haste(weights, spare, speed, limits[0], dt)
        total += critics.smoothness(weights, w, before) + critics.progress(last, steps)
    total += last
    if last > CLOSE:
        dx = _slope(cost_to_go, frame, x, y, SLOPE, 0.0)
        dy = _slope(cost_to_go, frame, x, y, 0.0, SLOPE)
        steep = math.hypot(dx, dy)
        if 1e-6 < steep < STEEPEST:
            total += critics.heading(weights, yaw, dx, dy, steep)
    return total


@numba.njit(cache=True)
def _from_movers(
    movers: Array, ahead: float, discs: Array, x: float, y: float, yaw: float
) -> float:
    """Clearance of the footprint at a pose from what moves, `ahead` s from now, m."""
    ahead = min(ahead, AHEAD)
    c = math.cos(yaw)
    s = math.sin(yaw)
    least = 1e9
    for i in range(movers.shape[0]):
        px = movers[i, 0] + movers[i, 2] * ahead
        py = movers[i, 1] + movers[i, 3] * ahead
        for k in range(discs.shape[0]):
            dx = x + c * discs[k, 0] - s * discs[k, 1] - px
            dy = y + s * discs[k, 0] + c * discs[k, 1] - py
            least = min(least, math.hypot(dx, dy) - discs[k, 2] - RADIUS)
    return least


@numba.njit(cache=True, inline="always")
def _to_go(cost_to_go: Field, frame: Array, x: float, y: float) -> float:
    column = (x - frame[0]) / frame[2] - 0.5
    row = (y - frame[1]) / frame[2] - 0.5
    return sample(cost_to_go, column, row, 1e6)


@numba.njit(cache=True, inline="always")
def _slope(
    cost_to_go: Field, frame: Array, x: float, y: float, along_x: float, along_y: float
) -> float:
    """Return the difference of the remaining distance between two points beside (x, y), m."""
    ahead = _to_go(cost_to_go, frame, x + along_x, y + along_y)
    return ahead - _to_go(cost_to_go, frame, x - along_x, y - along_y)

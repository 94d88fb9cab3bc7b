"""The local controller: model predictive path integral control (Williams et al. 2017)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np

from momantu_bt.geometry import Array, Pose2D
from momantu_bt.robot import BaseLimits
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.map.costmap import Costmap, room
from momantu_skills.navigation.map.fields import Field, sample
from momantu_skills.navigation.plan.planner import Plan


@dataclass(frozen=True, slots=True)
class MppiConfig:
    """Sampling and weights.

    samples: rollouts per call. steps, step: horizon, count and s. knots: noise is drawn at this
    many instants and interpolated, so that rollouts are smooth. speed_noise, turn_noise: standard
    deviations, m/s and rad/s. temperature: of the weights, in cost units (metres to the goal).
    collision, nearness, haste, heading, smoothness: weights of the terms, see `_cost`.
    """

    samples: int = 300
    steps: int = 22
    step: float = 0.1
    knots: int = 6
    speed_noise: float = 0.30
    turn_noise: float = 0.60
    temperature: float = 0.08
    collision: float = 60.0
    nearness: float = 1.0
    haste: float = 25.0
    heading: float = 0.7
    smoothness: float = 0.05


class Mppi:
    """Remembers the last plan of controls and improves it at each call."""

    def __init__(
        self,
        limits: BaseLimits,
        navigation: NavigationConfig,
        random: np.random.Generator,
        config: MppiConfig | None = None,
    ) -> None:
        self._config = config or MppiConfig()
        self._random = random
        self._limits = np.array(
            [
                min(limits.linear, navigation.speed),
                limits.angular,
                limits.linear_acceleration,
                limits.angular_acceleration,
            ]
        )
        c = self._config
        self._terms = np.array(
            [c.collision, c.nearness, c.haste, c.heading, c.smoothness, navigation.margin,
             navigation.comfort, navigation.near_speed, navigation.far_clearance]
        )  # fmt: skip
        at = np.linspace(0.0, c.knots - 1.0, c.steps)
        low = np.minimum(at.astype(np.int64), c.knots - 2)
        self._blend = np.zeros((c.steps, c.knots))
        self._blend[np.arange(c.steps), low] = 1.0 - (at - low)
        self._blend[np.arange(c.steps), low + 1] = at - low
        self.restart()

    def restart(self) -> None:
        """Forget the last controls: the base was driven by something else."""
        self._controls = np.zeros((self._config.steps, 2))

    def command(
        self, pose: Pose2D, speed: tuple[float, float], costmap: Costmap, discs: Array, plan: Plan
    ) -> tuple[float, float]:
        """Next (m/s, rad/s) from a pose in the map and the measured (m/s, rad/s)."""
        c = self._config
        shift = max(1, round(0.1 / c.step))
        self._controls = np.concatenate(
            [self._controls[shift:], self._controls[-1:].repeat(shift, 0)]
        )
        noise = self._random.standard_normal((c.samples, c.knots, 2))
        noise *= (c.speed_noise, c.turn_noise)
        controls = self._controls + np.einsum("tk,skc->stc", self._blend, noise)
        controls[0] = self._controls
        controls[1] = 0.0
        controls[2] = (self._limits[0], 0.0)
        np.clip(controls[..., 0], 0.0, self._limits[0], out=controls[..., 0])
        np.clip(controls[..., 1], -self._limits[1], self._limits[1], out=controls[..., 1])
        start = np.array([pose.x, pose.y, pose.yaw, speed[0], speed[1]])
        costs = _costs(
            start, controls, c.step, costmap.field, costmap.frame, discs, plan.cost, self._limits,
            self._terms,
        )  # fmt: skip
        weights = np.exp((costs.min() - costs) / c.temperature)
        self._controls = np.einsum("s,stc->tc", weights / weights.sum(), controls)
        return float(self._controls[0, 0]), float(self._controls[0, 1])


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
    terms: Array,
) -> Array:
    costs = np.empty(controls.shape[0])
    for i in range(controls.shape[0]):
        costs[i] = _cost(start, controls[i], dt, field, frame, discs, cost_to_go, limits, terms)
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
    terms: Array,
) -> float:
    """One rollout of a unicycle within acceleration limits.

    Metres still to go at its end and on average; collision (the earlier the worse); nearness
    times speed; haste (speed above what the room allows); heading against the way down the
    cost-to-go at its end; changes of turning.
    """
    x, y, yaw, v, w = start[0], start[1], start[2], start[3], start[4]
    steps = controls.shape[0]
    total = 0.0
    here = min(_to_go(cost_to_go, frame, x, y), 1e5)
    last = here
    worst = here + 3.0
    for t in range(steps):
        before = w
        v += min(max(controls[t, 0] - v, -limits[2] * dt), limits[2] * dt)
        w += min(max(controls[t, 1] - w, -limits[3] * dt), limits[3] * dt)
        yaw += 0.5 * w * dt
        x += v * math.cos(yaw) * dt
        y += v * math.sin(yaw) * dt
        yaw += 0.5 * w * dt
        spare = room(field, frame, discs, x, y, yaw) - terms[5]
        last = min(_to_go(cost_to_go, frame, x, y), worst)
        if spare < 0.0:
            total += terms[0] * (steps - t) / steps + 10.0 * min(-spare, 0.3)
            break
        share = min(spare / (terms[8] - terms[5]), 1.0)
        allowed = terms[7] + share * (limits[0] - terms[7])
        total += terms[1] * math.exp(-spare / terms[6]) * (0.1 + v) * dt
        total += terms[2] * max(0.0, v - allowed) ** 2 * dt
        total += terms[4] * (w - before) ** 2 + 0.3 * last / steps
    total += last
    if last > 0.3:
        dx = _to_go(cost_to_go, frame, x + 0.1, y) - _to_go(cost_to_go, frame, x - 0.1, y)
        dy = _to_go(cost_to_go, frame, x, y + 0.1) - _to_go(cost_to_go, frame, x, y - 0.1)
        steep = math.hypot(dx, dy)
        if 1e-6 < steep < 100.0:
            total += terms[3] * (1.0 + (math.cos(yaw) * dx + math.sin(yaw) * dy) / steep)
    return total


@numba.njit(cache=True, inline="always")
def _to_go(cost_to_go: Field, frame: Array, x: float, y: float) -> float:
    column = (x - frame[0]) / frame[2] - 0.5
    row = (y - frame[1]) / frame[2] - 0.5
    return sample(cost_to_go, column, row, 1e6)

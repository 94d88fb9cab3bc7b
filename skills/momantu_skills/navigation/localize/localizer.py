"""Adaptive Monte Carlo localization on a likelihood field, independent of robots and clocks."""

from __future__ import annotations

import math

import numpy as np

from momantu_bt.formats.maps import FREE, OCCUPIED
from momantu_bt.geometry import Array, Pose2D
from momantu_skills.navigation.config import LocalizationConfig
from momantu_skills.navigation.localize.belief import covariance, main_cluster
from momantu_skills.navigation.localize.fit import scan_fit
from momantu_skills.navigation.localize.hypotheses import Hypothesis, PlaceSearch
from momantu_skills.navigation.localize.particle_filter import (
    kld_resample,
    likelihood_field,
    log_likelihoods,
)
from momantu_skills.navigation.map.fields import surface_distance
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.map.sensing import Rays

FOUND = (0.1, 0.06)
"""Standard deviations around a place that was found on the whole map, m and rad."""


class Localizer:
    """Particles in the map, moved by odometry and weighted by scans.

    estimate: mean of the main cluster. covariance: (3, 3) of all particles, m2, m rad, rad2.
    quality: 0..1, fit of the newest scan at the estimate. After `spread` there are no particles but
    the places of a `PlaceSearch`, until one of them is left.
    """

    def __init__(
        self, grid: GridMap, config: LocalizationConfig, random: np.random.Generator
    ) -> None:
        self._config, self._random = config, random
        self._search: PlaceSearch | None = None
        self.use_map(grid)
        self.reset(Pose2D(0.0, 0.0, 0.0), 0.0, 0.0)

    def use_map(self, grid: GridMap) -> None:
        """Compare scans with this map from now on; the particles stay.

        Raises:
            ValueError: the map has no free cell.
        """
        self._grid = grid
        self._field = surface_distance(grid.cells == OCCUPIED, grid.resolution, self._config.reach)
        self._free = grid.centers(grid.cells == FREE)
        if not len(self._free):
            raise ValueError("the map has no free cell, so a robot cannot be anywhere on it")
        sigma, share = self._config.hit_sigma, self._config.random_share
        self._likelihood = likelihood_field(self._field, sigma, share)
        if self._search is not None:
            self.spread()

    def reset(self, pose: Pose2D, sigma_position: float, sigma_yaw: float) -> None:
        """Restart around a pose; standard deviations in m (each axis) and rad."""
        spread = np.array([sigma_position, sigma_position, sigma_yaw])
        count = max(2_000, self._config.particles[0])
        noise = self._random.standard_normal((count, 3)) * spread
        self._search = None
        self._start(np.array([pose.x, pose.y, pose.yaw]) + noise, pose)

    def spread(self) -> None:
        """Restart everywhere on the free floor; the next scan is compared with every pose."""
        self._start(self._anywhere(self._config.particles[1]), self.estimate)
        self._search = PlaceSearch(self._grid, self._field, self._config)

    @property
    def lost(self) -> bool:
        """Whether the robot is being sought on the whole map."""
        return self._search is not None

    @property
    def places(self) -> tuple[Hypothesis, ...]:
        """Where the robot may be, likeliest first; empty while particles are used."""
        return () if self._search is None else self._search.places

    def _start(self, poses: Array, guess: Pose2D) -> None:
        self._poses = poses
        self._slow = self._fast = 0.0
        self.quality = 0.0
        self._settle(np.ones(len(poses)), guess)

    def _settle(self, weights: Array, guess: Pose2D) -> None:
        self.estimate = main_cluster(self._poses, weights, guess)
        self.covariance = covariance(self._poses, weights, self.estimate)

    def _anywhere(self, count: int) -> Array:
        cells = self._free[self._random.integers(len(self._free), size=count)]
        offsets = (self._random.random((count, 2)) - 0.5) * self._grid.resolution
        yaw = self._random.uniform(-math.pi, math.pi, (count, 1))
        return np.concatenate([cells + offsets, yaw], axis=1)

    def move(self, delta: Pose2D) -> None:
        """Move the particles by odometry's `delta`, in the base's frame before the motion."""
        if self._search is not None:
            self._search.move(delta)
            self.estimate = self.estimate @ delta
            return
        spread = self._config.odometry_deviation(delta)
        noise = self._random.standard_normal((len(self._poses), 3)) * spread
        yaw = self._poses[:, 2] + 0.5 * noise[:, 2]
        x, y = delta.x + noise[:, 0], delta.y + noise[:, 1]
        self._poses[:, 0] += np.cos(yaw) * x - np.sin(yaw) * y
        self._poses[:, 1] += np.sin(yaw) * x + np.cos(yaw) * y
        self._poses[:, 2] += delta.yaw + noise[:, 2]
        self.estimate = self.estimate @ delta

    def jitter(self, sigma: float) -> None:
        """Move every particle slightly, sigma in m and rad, so that they stay diverse at rest."""
        self._poses += self._random.standard_normal(self._poses.shape) * (sigma, sigma, 0.7 * sigma)

    def observe(self, rays: Rays) -> None:
        """Weight the particles by a scan, estimate the pose, and resample."""
        points = rays.thinned(self._config.beams)
        if not len(points):
            self.quality = 0.0
            return
        if self._search is not None:
            self._look_for(rays, self._search)
            return
        logs = self._logs(points)
        weights = np.exp(self._config.trust * (logs - logs.max()))
        self._settle(weights, self.estimate)
        self.quality = scan_fit(self._grid, self._field, self.estimate, rays)
        self._resample(weights / weights.sum(), self._injected(logs, len(points)))

    def _look_for(self, rays: Rays, search: PlaceSearch) -> None:
        """Find the places that fit; go on with particles around the last one that is left."""
        search.see(rays)
        if search.found is not None:
            self.reset(search.found, *FOUND)
        elif search.places:
            self.estimate = search.places[0].pose
            self.covariance = search.covariance()
        self.quality = scan_fit(self._grid, self._field, self.estimate, rays)

    def _logs(self, points: Array) -> Array:
        config, grid = self._config, self._grid
        result: Array = log_likelihoods(
            self._poses,
            points,
            self._likelihood,
            *grid.origin,
            grid.resolution,
            config.random_share,
        )
        return result

    def _injected(self, logs: Array, beams: int) -> float:
        """Share of random particles, from the ratio of the recent to the long-term average fit."""
        config = self._config
        typical = float(np.exp(logs.max() / beams))
        if self._slow == 0.0:
            self._slow = self._fast = typical
        self._slow += config.slow * (typical - self._slow)
        self._fast += config.fast * (typical - self._fast)
        return min(config.injected_most, max(0.0, 1.0 - self._fast / self._slow - 0.1))

    def _resample(self, weights: Array, injected: float) -> None:
        config = self._config
        chosen = kld_resample(
            self._poses,
            weights,
            self._random.random(config.particles[1]),
            config.particles[0],
            *config.bin_size,
            config.kld_error,
            config.kld_quantile,
        )
        drawn = self._poses[chosen]
        extra = int(injected * len(drawn))
        self._poses = np.concatenate([drawn, self._anywhere(extra)]) if extra else drawn

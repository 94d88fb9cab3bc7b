"""Localization without a map: odometry, whose frame takes the map's place."""

from __future__ import annotations

import numpy as np

from momantu_bt.geometry import Array, Pose2D
from momantu_skills.navigation.localize.hypotheses import Hypothesis
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.map.sensing import Rays


class OdometryAlone:
    """What `Localizer` offers, by odometry. Poses are exact, as they say only where odometry is.

    estimate: the pose. covariance: zero. quality: 1.
    """

    places: tuple[Hypothesis, ...] = ()
    lost = False
    quality = 1.0

    def __init__(self, start: Pose2D) -> None:
        self.estimate = start
        self.covariance: Array = np.zeros((3, 3))

    def move(self, delta: Pose2D) -> None:
        """Follow odometry's `delta`, in the base's frame before the motion."""
        self.estimate = self.estimate @ delta

    def reset(self, pose: Pose2D, sigma_position: float, sigma_yaw: float) -> None:
        """Stay: there is no map on which the robot could be elsewhere."""

    def spread(self) -> None:
        """Stay: there is no map on which the robot could be elsewhere."""

    def use_map(self, grid: GridMap) -> None:
        """There is none."""

    def jitter(self, sigma: float) -> None:
        """Nothing is at random."""

    def observe(self, rays: Rays) -> None:
        """A scan says nothing without a map."""

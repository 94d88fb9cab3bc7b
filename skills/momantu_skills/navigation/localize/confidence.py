"""When the robot counts as localized."""

from __future__ import annotations

import math
from typing import Any

from momantu_bt.claim import BaseAt
from momantu_bt.geometry import Array
from momantu_bt.service import Localization, offers
from momantu_skills.navigation.map.own import OwnMap

POSITION_SIGMA = 0.15
"""Largest standard deviation of the position, m: half of the smallest tolerance in a doorway one
metre wide."""
YAW_SIGMA = 0.12
"""Largest standard deviation of the yaw, rad: 7 degrees."""
QUALITY = 0.7
"""Least fit of the newest scan (0 to 1); the usual fit is 0.95 or more."""


def sigmas(covariance: Array) -> tuple[float, float]:
    """Standard deviations from a (3, 3): position along its widest axis, m, and yaw, rad."""
    a, b, c = float(covariance[0, 0]), float(covariance[0, 1]), float(covariance[1, 1])
    widest = 0.5 * (a + c) + math.sqrt(0.25 * (a - c) ** 2 + b * b)
    return math.sqrt(max(widest, 0.0)), math.sqrt(max(float(covariance[2, 2]), 0.0))


def published(localization: Localization) -> dict[str, Any]:
    """What localization tells: quality, sigma_position in m, sigma_yaw in rad, pose in the map."""
    position, yaw = sigmas(localization.covariance)
    return {
        "quality": localization.quality,
        "sigma_position": position,
        "sigma_yaw": yaw,
        "pose": localization.map_from_base,
    }


def is_localized(localization: Localization, quality: float = QUALITY) -> bool:
    """Whether the covariance is small and the newest scan fits the map by `quality` or more."""
    position, yaw = sigmas(localization.covariance)
    return position < POSITION_SIGMA and yaw < YAW_SIGMA and localization.quality > quality


def estimate(localization: Localization) -> BaseAt | None:
    """Claim that the base is at its estimate, with the accuracy that driving needs.

    None on a map that the robot makes itself: nobody else knows where that lies.
    """
    if offers(localization, OwnMap):
        return None
    return BaseAt(localization.map_from_base, POSITION_SIGMA, YAW_SIGMA)

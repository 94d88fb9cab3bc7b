"""When the robot counts as localized."""

from __future__ import annotations

import math

from momantu_bt.claim import BaseAt
from momantu_bt.geometry import Array
from momantu_bt.service import Localization

POSITION_SIGMA = 0.15
"""m: half of the narrowest room for error in a doorway one metre wide."""
YAW_SIGMA = 0.12
"""rad: 7 degrees."""
QUALITY = 0.7
"""Fit of the newest scan below which the estimate is doubted; usual is 0.95 and more."""


def sigmas(covariance: Array) -> tuple[float, float]:
    """Standard deviations (position in m along its widest axis, yaw in rad) of a (3, 3)."""
    a, b, c = float(covariance[0, 0]), float(covariance[0, 1]), float(covariance[1, 1])
    widest = 0.5 * (a + c) + math.sqrt(0.25 * (a - c) ** 2 + b * b)
    return math.sqrt(max(widest, 0.0)), math.sqrt(max(float(covariance[2, 2]), 0.0))


def is_localized(localization: Localization, quality: float = QUALITY) -> bool:
    """Whether the estimate is narrow and the newest scan agrees with it by `quality` or more."""
    position, yaw = sigmas(localization.covariance)
    return position < POSITION_SIGMA and yaw < YAW_SIGMA and localization.quality > quality


def estimate(localization: Localization) -> BaseAt:
    """The claim that the base is where it is believed to be, as well as driving needs to know."""
    return BaseAt(localization.map_from_base, POSITION_SIGMA, YAW_SIGMA)

"""Light and noise in colour pictures: how many to average, and when it is too dark to see."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from momantu_bt.lazy import lazily

with lazily():
    import cv2

GAMMA = 2.2
"""Gamma of the camera's colours."""
DIM = 0.1
"""Median light, as a share of white, below which a picture is searched in lifted light too."""
LIFTED = 0.5
"""Median light of a picture whose light is lifted."""
GRAIN = 0.3
"""Noise of a pixel's light that is low enough to read a tag, as a share of the light."""
MOST_PICTURES = 16
"""Most pictures that are averaged."""
ROUNDING = 0.29
"""Sigma of rounding to whole grey levels."""
_LAPLACIAN = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], dtype=np.float32)
"""Difference of two Laplacians, blind to edges and shades (Immerkaer 1996); its norm is 6."""
_NORM, _MEDIAN = 6.0, 0.6745
"""That norm; the median of the absolute value of a standard normal variable."""


@dataclass(frozen=True, slots=True)
class Brightness:
    """mean: grey level of 0..255. light: median, as a share of white. noise: sigma, grey levels."""

    mean: float
    light: float
    noise: float

    @property
    def grain(self) -> float:
        """Noise of a pixel's light as a share of the light; inf where there is none."""
        level = 255.0 * self.light ** (1.0 / GAMMA)
        return GAMMA * max(self.noise, ROUNDING) / level if level > 0.0 else math.inf

    @property
    def pictures(self) -> int:
        """How many pictures must be averaged to read a tag; at most `MOST_PICTURES`."""
        return max(1, math.ceil(min((self.grain / GRAIN) ** 2, MOST_PICTURES)))

    @property
    def too_dark(self) -> bool:
        """Whether not even the average of the most pictures is clear enough."""
        return self.grain > GRAIN * math.sqrt(MOST_PICTURES)


def brightness(gray: NDArray[np.uint8]) -> Brightness:
    """The brightness of a picture (H, W), with its noise measured robustly against edges."""
    bends = cv2.filter2D(gray, cv2.CV_32F, _LAPLACIAN)
    noise = float(np.median(np.abs(bends))) / _MEDIAN / _NORM
    return Brightness(float(gray.mean()), float(_light()[int(np.median(gray))]), noise)


def light_of(grays: Sequence[NDArray[np.uint8]]) -> NDArray[np.float32]:
    """Mean light (H, W), as a share of white, of pictures taken from one place."""
    total = np.zeros(grays[0].shape, dtype=np.float32)
    for gray in grays:
        total += _light()[gray]
    return total / np.float32(len(grays))


def levels(light: NDArray[np.float32], lift: float = 1.0) -> NDArray[np.uint8]:
    """Light (H, W) times `lift` in 256 steps, without gamma; what is brighter than white is cut."""
    return np.asarray(np.rint(np.clip(light * np.float32(255.0 * lift), 0.0, 255.0)), np.uint8)


def lift_of(light: NDArray[np.float32]) -> float | None:
    """The factor that brings the picture's median to `LIFTED`; None if it is not dim."""
    median = float(np.median(light))
    return None if median >= DIM else LIFTED / max(median, 1e-4)


@lru_cache(maxsize=1)
def _light() -> NDArray[np.float32]:
    """Table (256,) from a grey level to its light, as a share of white."""
    return ((np.arange(256) / 255.0) ** GAMMA).astype(np.float32)

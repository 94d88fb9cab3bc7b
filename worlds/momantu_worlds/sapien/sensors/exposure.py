"""The exposure of a colour sensor: time and gain chosen by the light, and the noise they bring.

The model is the usual one of image sensors (EMVA standard 1288): electrons are counted with shot
noise, each reading adds its own noise, and gain amplifies both. The picture that is taken is
metered itself, as after the few pictures in which a real camera adapts.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_bt.robot_parts import Exposure

GAMMA = 2.2
"""Gamma of the camera's colours."""
LEAST, MOST = 0.06, 0.65
"""Range of a picture's mean light, as shares of white, in which the usual exposure stays."""
AIM = 0.18
"""Mean light that another exposure aims at, as a share of white: middle grey."""
CEILING = 16.0
"""Light above which a pixel counts no more in metering, as a share of white at usual exposure."""
STEP = 4
"""Every so many rows and columns are metered, px."""
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Weights of red, green and blue in brightness (ITU-R BT.709)."""


@dataclass(frozen=True, slots=True)
class Setting:
    """One picture's exposure. time: as a multiple of the usual one. gain: at least 1.

    full_well, read_noise: the sensor's, electrons.
    """

    time: float
    gain: float
    full_well: float
    read_noise: float


def well_lit(color: NDArray[np.uint8]) -> bool:
    """Whether colours (h, w, >=3) at the usual exposure are neither too dark nor too bright."""
    return LEAST <= _mean_light(color) <= MOST


def metered(radiance: NDArray[np.float32], exposure: Exposure) -> Setting:
    """The setting for light (h, w, 3), where 1 is white at the usual exposure.

    First the exposure grows up to the longest, then the gain up to the greatest.
    """
    some = np.minimum(radiance[::STEP, ::STEP].astype(np.float64), CEILING)
    mean = float((some @ LUMINANCE).mean())
    factor = min(AIM / max(mean, 1e-9), exposure.most)
    time = min(factor, exposure.longest / exposure.usual)
    return Setting(time, max(1.0, factor / time), exposure.full_well, exposure.read_noise)


def expose(
    radiance: NDArray[np.float32], setting: Setting, random: np.random.Generator
) -> NDArray[np.uint8]:
    """Colours (h, w, 3) of light (h, w, 3) taken with a setting, with shot and read noise."""
    electrons = radiance * np.float32(setting.time * setting.full_well)
    sigma = np.sqrt(electrons + np.float32(setting.read_noise**2))
    electrons += sigma * random.standard_normal(radiance.shape, dtype=np.float32)
    electrons *= np.float32(setting.gain / setting.full_well)
    light = np.clip(electrons, 0.0, 1.0, out=electrons)
    return np.asarray(np.rint(255.0 * light ** np.float32(1.0 / GAMMA)).astype(np.uint8))


def _mean_light(color: NDArray[np.uint8]) -> float:
    return float((_light()[color[::STEP, ::STEP, :3]] @ LUMINANCE).mean())


@lru_cache(maxsize=1)
def _light() -> Array:
    """Table (256,) from a colour's value to its light, as a share of white."""
    return np.asarray((np.arange(256) / 255.0) ** GAMMA)

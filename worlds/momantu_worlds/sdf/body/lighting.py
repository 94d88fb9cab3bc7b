"""Lights of a world file, made from those of an SDF world."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_worlds.sdf.body.parts import Rgb
from momantu_worlds.sdf.deviations import Deviations
from momantu_worlds.sdf.read.model import Light, LightKind, Rgba

LAMP = 5.0
"""Strength at 1 m of a lamp that is white in SDF: a medium value in the bundled worlds."""
AMBIENT = (0.3, 0.45)
"""Default range of ambient light."""
DARKEST = 0.15
"""Least ambient light; a camera sees little with less."""
MOST_SUNS, MOST_BULBS = 8, 60


@dataclass(frozen=True, slots=True)
class Lighting:
    """suns: directions and colours. bulbs: positions, and colours at 1 m."""

    ambient: tuple[float, float]
    suns: tuple[tuple[Rgb, Rgb], ...]
    bulbs: tuple[tuple[Rgb, Rgb], ...]


def lighting(
    lights: Iterable[tuple[Light, str, Transform]],
    ambient: Rgba | None,
    height: float,
    deviations: Deviations,
) -> Lighting:
    """The lights of a world; height: of the floor in the SDF world, m."""
    suns: list[tuple[Rgb, Rgb]] = []
    bulbs: list[tuple[Rgb, Rgb]] = []
    for light, subject, pose in lights:
        kind, most = (suns, MOST_SUNS) if light.kind is LightKind.SUN else (bulbs, MOST_BULBS)
        if len(kind) == most:
            what = f"a {light.kind} light beyond the first {most}"
            deviations.dropped(light.place, subject, what, "left out")
        elif light.kind is LightKind.SUN:
            suns.append((_three(pose.rotation @ np.array(light.direction)), light.diffuse[:3]))
        else:
            at = pose.position - (0.0, 0.0, height)
            bulbs.append((_three(at), _three(LAMP * np.array(light.diffuse[:3]))))
    level = AMBIENT
    if ambient is not None:
        mean = max(float(np.mean(ambient[:3])), DARKEST)
        level = (mean, mean)
    return Lighting(level, tuple(suns), tuple(bulbs))


def _three(values: Array) -> Rgb:
    x, y, z = (float(value) for value in values)
    return x, y, z

"""Whether a camera reads a tag that it sees: the light on the tag, and the size of its squares."""

from __future__ import annotations

import math

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.robot_parts import CameraSensor, Exposure
from momantu_worlds.scenes.geometry.bodies import Episode

LEAST_CELL = 1.4
"""Narrowest width of a square that can be read, px."""
GRAIN = 0.6
"""Largest noise of a pixel, as a share of its light, with which the mean of several pictures can be
read."""
MIDDLE = 0.5
"""Light between a tag's black and white, as a share of the light on it."""


def light_on(episode: Episode, point: Array, normal: Array) -> float:
    """Green light on a small area at a point (3,) that faces `normal`, map; without shadows.

    On 1, white paper is just white at a camera's usual exposure. It is the renderer's rule.
    """
    light = float(episode.ambient[1])
    for sun in episode.suns:
        toward = -np.asarray(sun.direction) / float(np.linalg.norm(sun.direction))
        light += sun.color[1] * max(float(normal @ toward), 0.0) / math.pi
    for lamp in episode.lamps:
        way = np.asarray(lamp.position) - point
        square = max(float(way @ way), 1e-4)
        light += lamp.color[1] * max(float(normal @ way), 0.0) / (math.pi * square**1.5)
    return light


def least_light(exposure: Exposure) -> float:
    """Least light on a tag that a camera with this exposure can read at its longest."""
    read = exposure.read_noise
    # electrons n at which the noise sqrt(n + read^2) is `GRAIN` of the light n
    electrons = (1 + math.sqrt(1 + (2 * GRAIN * read) ** 2)) / (2 * GRAIN**2)
    return electrons * exposure.usual / (MIDDLE * exposure.full_well * exposure.longest)


def cell_widths(
    camera: CameraSensor, eyes: Array, middle: Array, normal: Array, cell: float
) -> Array:
    """Narrow side (n,) of a square of a tag as seen from eyes (n, 3), px; cell: its side, m."""
    rays = eyes - middle
    distances = np.linalg.norm(rays, axis=1)
    focal = camera.width / 2 / math.tan(camera.horizontal_fov / 2)
    slant = np.maximum(rays @ normal, 0.0) / distances
    return np.asarray(focal * cell * slant / distances)

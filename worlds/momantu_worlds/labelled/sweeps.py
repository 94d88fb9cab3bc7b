"""Meshes that are swept along a line, and blocks with round edges."""

from __future__ import annotations

import math

import numpy as np

from momantu_bt.geometry import Array
from momantu_worlds.scenes.geometry.bodies import Hull, Mesh

AROUND = 8
"""Points around a tube."""
CORNER = 4
"""Points on a round edge."""


def tube(line: Array, wide: float, thick: float) -> Mesh:
    """A tube with an elliptic cut along points (n, 3) of the plane y = 0, m.

    wide: half its extent along y. thick: half its extent across, within the plane.
    """
    ahead = np.gradient(line, axis=0)
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    across = np.cross(ahead, (0.0, 1.0, 0.0))
    turns = np.linspace(0.0, 2.0 * math.pi, AROUND, endpoint=False)
    rings = (
        line[:, None]
        + thick * np.cos(turns)[None, :, None] * across[:, None]
        + wide * np.sin(turns)[None, :, None] * np.array([0.0, 1.0, 0.0])
    )
    first = np.arange(len(line) - 1)[:, None] * AROUND + np.arange(AROUND)
    beside = np.arange(len(line) - 1)[:, None] * AROUND + (np.arange(AROUND) + 1) % AROUND
    quads = np.stack([first, beside, beside + AROUND, first + AROUND], axis=-1).reshape(-1, 4)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return Mesh(rings.reshape(-1, 3), triangles.astype(np.int32))


def rounded_block(size: tuple[float, float, float], radius: float) -> Hull:
    """A block whose edges along z are round, m."""
    x, y, z = (edge / 2 for edge in size)
    quarter = np.linspace(0.0, math.pi / 2, CORNER)
    corner = radius * np.column_stack([np.cos(quarter), np.sin(quarter)]) + (x - radius, y - radius)
    flat = np.concatenate([corner * (a, b) for a in (-1, 1) for b in (-1, 1)])
    return Hull(np.concatenate([np.column_stack([flat, np.full(len(flat), h)]) for h in (-z, z)]))

"""Bodies of revolution: triangles to look at, and convex pieces to collide with."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from momantu_bt.geometry import Array
from momantu_worlds.scenes.geometry.bodies import Hull, Mesh

Profile: TypeAlias = Sequence[tuple[float, float]]
"""(radius, height) points in m, from bottom to top along the outside, then down the inside."""

SEGMENTS = 28
"""Faces around; at 35 mm radius each is 8 mm wide, too small for the depth camera to resolve."""

FLAT = 0.0015
"""m; largest distance of a flat side from the round surface that it approximates."""


def lathe(profile: Profile, segments: int = SEGMENTS) -> Mesh:
    """The surface that a profile sweeps around z.

    Each band has its own vertices, so that edges of the profile stay sharp. A point on the axis has
    radius 0; bands without extent are left out.
    """
    angles = np.arange(segments) * (2 * math.pi / segments)
    ring = np.stack([np.cos(angles), np.sin(angles), np.zeros(segments)], axis=1)
    vertices: list[Array] = []
    triangles: list[Array] = []
    for (r0, z0), (r1, z1) in pairwise(profile):
        first = sum(len(v) for v in vertices)
        vertices += [ring * r0 + (0, 0, z0), ring * r1 + (0, 0, z1)]
        low = first + np.arange(segments)
        low_next = first + (np.arange(segments) + 1) % segments
        if r1 > 0:
            triangles.append(np.stack([low, low_next + segments, low + segments], axis=1))
        if r0 > 0:
            triangles.append(np.stack([low, low_next, low_next + segments], axis=1))
    return Mesh(np.concatenate(vertices), np.concatenate(triangles).astype(np.int32))


def panel(radius: float, low: float, high: float, angle: float) -> Mesh:
    """A piece of an upright cylinder's surface, `angle` rad wide around +x, between two heights."""
    count = max(2, math.ceil(SEGMENTS * angle / (2 * math.pi)))
    turns = np.linspace(-angle / 2, angle / 2, count + 1)
    ring = np.stack([radius * np.cos(turns), radius * np.sin(turns), np.zeros(count + 1)], axis=1)
    below = np.arange(count)
    above = below + count + 1
    triangles = np.concatenate(
        [
            np.stack([below, below + 1, above + 1], axis=1),
            np.stack([below, above + 1, above], axis=1),
        ]
    )
    vertices = np.concatenate([ring + np.array([0.0, 0.0, z]) for z in (low, high)])
    return Mesh(vertices, triangles.astype(np.int32))


def sectors(radius: float) -> int:
    """Pieces around a wall of that radius whose flat sides lie within FLAT of the round ones."""
    return max(8, math.ceil(math.pi / math.acos(1.0 - FLAT / radius)))


def shell_pieces(outer: Profile, inner: Profile, pieces: int) -> tuple[Hull, ...]:
    """Convex pieces of a hollow body's wall: one for each band and each of `pieces` sectors.

    outer, inner: profiles of the wall from bottom to top, of equal length.
    """
    hulls = []
    for i in range(len(outer) - 1):
        corners = (outer[i], outer[i + 1], inner[i], inner[i + 1])
        for k in range(pieces):
            turns = (2 * math.pi * k / pieces, 2 * math.pi * (k + 1) / pieces)
            hulls.append(
                Hull(
                    np.array(
                        [(r * math.cos(t), r * math.sin(t), z) for t in turns for r, z in corners]
                    )
                )
            )
    return tuple(hulls)


def solid_piece(profile: Profile, segments: int = 16) -> Hull:
    """The convex hull of a profile swept around z; at most 64 points come of 4 rings of 16."""
    angles = np.arange(segments) * (2 * math.pi / segments)
    ring = np.stack([np.cos(angles), np.sin(angles), np.zeros(segments)], axis=1)
    return Hull(np.concatenate([ring * r + (0, 0, z) for r, z in profile]))

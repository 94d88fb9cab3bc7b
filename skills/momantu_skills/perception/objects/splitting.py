"""Separate objects that touch: first upright round bodies, then the remaining points."""

from __future__ import annotations

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.world import seeded
from momantu_skills.perception.geometry.grids import Mask
from momantu_skills.perception.geometry.revolution import fit_revolution
from momantu_skills.perception.surface.segment import SegmentConfig, Thing, taken_out

SAMPLES = 300
"""Triples of points that are tried; with three objects in contact one in 27 is from one object."""
RADII = (0.015, 0.12)
"""Range of radii of the bodies that are searched, m."""
CLOSE = 0.003
"""Distance to a circle within which a point supports it, m."""
LEAST_SUPPORT = 60
"""Fewest points on a circle that make it a body."""
MARGIN = 0.006
"""Margin around a body within which points belong to it, m."""
MOST_PARTS = 4
"""Most objects that one group is split into."""


def split(thing: Thing, config: SegmentConfig) -> list[Thing]:
    """The parts of a group that looks like several objects; the group itself otherwise."""
    rest: list[Thing] = [thing]
    parts: list[Thing] = []
    while rest and len(parts) < MOST_PARTS:
        clump = rest.pop(0)
        mask = _round_part(clump)
        if mask is None:
            parts.append(clump)
            continue
        parts.append(Thing(clump.points[mask], clump.side[mask]))
        rest.extend(taken_out(clump, mask, config))
    return parts + rest


def _round_part(clump: Thing) -> Mask | None:
    """Points of the best upright round body, (n,) bool; None if there is none, or nothing else."""
    side = clump.points[clump.side]
    if len(side) < LEAST_SUPPORT:
        return None
    circle = _best_circle(side[:, :2])
    if circle is None:
        return None
    centre, radius = circle
    near = np.abs(np.hypot(*(side[:, :2] - centre).T) - radius) < 2 * CLOSE
    body = fit_revolution(side[near])
    if body is None or not RADII[0] < body.radius < RADII[1]:
        return None
    distances = np.hypot(*(clump.points[:, :2] - body.centre).T)
    mask = np.asarray(distances < body.radius + MARGIN)
    return mask if int((~mask).sum()) >= LEAST_SUPPORT // 2 else None


def _best_circle(flat: Array) -> tuple[Array, float] | None:
    """Centre and radius of the circle with the most of the points (n, 2)."""
    random = seeded("circles", len(flat))
    triples = random.integers(0, len(flat), size=(SAMPLES, 3))
    a, b, c = (flat[triples[:, k]] for k in range(3))
    centres, radii = _circumcircles(a, b, c)
    fits = np.isfinite(radii) & (radii > RADII[0]) & (radii < RADII[1])
    if not fits.any():
        return None
    centres, radii = centres[fits], radii[fits]
    distances = np.linalg.norm(flat[None, :, :] - centres[:, None, :], axis=2)
    support = (np.abs(distances - radii[:, None]) < CLOSE).sum(axis=1)
    inside = (distances < radii[:, None] - 2 * CLOSE).sum(axis=1)
    worth = support - inside
    best = int(worth.argmax())
    if int(worth[best]) < LEAST_SUPPORT:
        return None
    return centres[best], float(radii[best])


def _circumcircles(a: Array, b: Array, c: Array) -> tuple[Array, Array]:
    """Centres (k, 2) and radii (k,) through three points each; infinite if they are collinear."""
    ab, ac = b - a, c - a
    double = 2.0 * (ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0])
    flat = np.abs(double) < 1e-9
    safe = np.where(flat, 1.0, double)
    ab2, ac2 = (ab**2).sum(axis=1), (ac**2).sum(axis=1)
    x = (ac[:, 1] * ab2 - ab[:, 1] * ac2) / safe
    y = (ab[:, 0] * ac2 - ac[:, 0] * ab2) / safe
    radii = np.where(flat, np.inf, np.hypot(x, y))
    return a + np.column_stack([x, y]), radii

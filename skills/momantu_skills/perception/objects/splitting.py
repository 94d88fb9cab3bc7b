"""Separating objects that touch: upright round bodies first, then the rest."""

from __future__ import annotations

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.world import seeded
from momantu_skills.perception.geometry.grids import Mask
from momantu_skills.perception.geometry.revolution import fit_revolution
from momantu_skills.perception.surface.segment import SegmentConfig, Thing, taken_out

SAMPLES = 300
"""Triples tried; three things that touch need 27 for one clean triple, and triples are small."""
RADII = (0.015, 0.12)
"""m; of the bodies that are looked for."""
CLOSE = 0.003
"""m; distance to a circle at which a point supports it."""
LEAST_SUPPORT = 60
"""Points on a circle that make a body of it."""
MARGIN = 0.006
"""m around a body within which points belong to it."""
MOST_PARTS = 4
"""More things than this do not touch each other in one clump."""


def split(thing: Thing, config: SegmentConfig) -> list[Thing]:
    """The parts of an object that looks like several; the object itself if it does not."""
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
    """(n,) bool: points of the best upright round body, or None when there is none, or only it."""
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
    """Centre and radius of the circle on which most of the points (n, 2) lie."""
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
    """Centres (k, 2) and radii (k,) through three points each; infinite where they are in line."""
    ab, ac = b - a, c - a
    double = 2.0 * (ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0])
    flat = np.abs(double) < 1e-9
    safe = np.where(flat, 1.0, double)
    ab2, ac2 = (ab**2).sum(axis=1), (ac**2).sum(axis=1)
    x = (ac[:, 1] * ab2 - ab[:, 1] * ac2) / safe
    y = (ab[:, 0] * ac2 - ac[:, 0] * ab2) / safe
    radii = np.where(flat, np.inf, np.hypot(x, y))
    return a + np.column_stack([x, y]), radii

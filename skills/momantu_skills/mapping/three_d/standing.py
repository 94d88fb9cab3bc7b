"""Where a floor lies under a sensor whose height nobody told: in the first turn of a log."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array, Transform, rotation_between
from momantu_skills.mapping.three_d.config import CloudConfig
from momantu_skills.mapping.three_d.floor import floor_plane

TILTS = np.radians(np.arange(-10.0, 10.5, 2.0))
"""Tilts about x and y that are tried, rad: how far off level a base or a mount may be."""
SLICE = 0.04
"""Thickness of the slices that are compared, m; each counts with its two neighbours."""
PATCH = 0.15
"""Edge of the patches by which the area of a slice is counted, m: near points are denser."""
FEWEST = 60
"""Fewest patches of a floor."""
MOST = 5000
"""Points by which the tilts are compared."""
BELOW = 0.08
"""Height of the lidar above a floor, at least, m."""
LEVEL, TOLD = 0.01, 0.03
"""Tilt, rad, and height, m, up to which a base stands on its floor as its frames tell."""
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True, eq=False)
class Standing:
    """`floor_from_base`: a frame on the floor, below the base's origin; note: in words.

    seen: whether a floor was found; if not, heights are those above the base's frame.
    """

    floor_from_base: Transform
    seen: bool
    note: str


def standing(
    points: Array, lidar: Array, up: Array | None, base: str, config: CloudConfig
) -> Standing:
    """Find the floor below a base in the points (n, 3) of one turn, in its frame.

    lidar: its place (3,) in the same frame. up: direction (3,) in base, if it is known better than
    by the frame's own z.
    """
    level = np.eye(3) if up is None or up[2] <= 0.0 else rotation_between(up, _UP)
    found = _fitted(points @ level.T, float((level @ lidar)[2]), config)
    if found is None:
        said = f"no floor was found below {base!r}: heights are above that frame"
        return Standing(Transform.from_rotation(level), False, said)
    turn, height = found[0] @ level, found[1]
    tilt = math.acos(min(1.0, float(turn[2, 2])))
    if tilt < LEVEL and abs(height) < TOLD:
        return Standing(Transform(), True, "")
    said = (
        f"the floor lies {-height:.2f} m below {base!r}"
        if height < 0.0
        else f"the floor lies {height:.2f} m above {base!r}"
    )
    tilted = f", which is tilted by {math.degrees(tilt):.1f} degrees" if tilt >= LEVEL else ""
    return Standing(
        Transform.from_rotation(turn, (0.0, 0.0, -height)),
        True,
        f"{said}{tilted}: heights are above the floor",
    )


def _fitted(points: Array, lidar: float, config: CloudConfig) -> tuple[Array, float] | None:
    """A rotation (3, 3) that levels the floor, and its height then, m, as seen from the origin."""
    near = points[np.hypot(points[:, 0], points[:, 1]) < config.floor_reach]
    few = near[:: 1 + len(near) // MOST]
    best, most = None, FEWEST - 1
    for roll, pitch in itertools.product(TILTS, TILTS):
        turn = Transform.from_rpy((0.0, 0.0, 0.0), (roll, pitch, 0.0)).rotation
        area, height = _widest(few @ turn.T, lidar - BELOW)
        if area > most:
            best, most = (turn, height), area
    if best is None:
        return None
    turn, height = best
    plane = floor_plane(near @ turn.T - (0.0, 0.0, height), config)
    if plane is None:
        return None
    level = rotation_between(plane[:3], _UP)
    return level @ turn, height * float(plane[2]) - float(plane[3])


def _widest(points: Array, highest: float) -> tuple[int, float]:
    """Patches of the level slice below a height that covers most, and its height, m."""
    below = points[points[:, 2] < highest]
    if not len(below):
        return 0, 0.0
    cells = np.floor(below[:, :2] / PATCH).astype(np.int64)
    slices = np.floor(below[:, 2] / SLICE).astype(np.int64)
    lowest = int(slices.min())
    patches = np.unique(np.column_stack([slices - lowest, cells]), axis=0)[:, 0]
    counts = np.bincount(patches, minlength=3)
    around = np.convolve(counts, [1, 1, 1], mode="same")
    best = int(np.argmax(around))
    middle = slices - lowest
    inside = below[np.abs(middle - best) <= 1]
    return int(around[best]), float(np.median(inside[:, 2]))

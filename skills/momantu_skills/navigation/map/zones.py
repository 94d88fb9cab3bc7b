"""A site's zones, as planner, controller and collision guard use them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Pose2D
from momantu_bt.zone import Zone, ZoneKind
from momantu_skills.navigation.map.fields import Field
from momantu_skills.navigation.map.maps import GridMap

DOUBT = 0.03
"""How far off the estimate of the base's pose may be, m: zones to keep out of count as so much
larger. A base that seems to overlap one by less does not stand in it."""
SPACING = 0.03
"""Distance between the points along a border that the collision guard keeps clear of, m."""
REACTION = 0.3
"""Time from a command to its effect, s: one control period, one scan, and the drive."""
BRAKE = 0.5
"""Share of the base's deceleration that it uses before a slow zone."""


class Zones:
    """The zones by their names; poses and points are in the map."""

    def __init__(self, zones: Mapping[str, Zone] = MappingProxyType({})) -> None:
        self._kept_out = _of_kind(zones, "keep_out")
        self._slow = _of_kind(zones, "slow")
        self._preferred = _of_kind(zones, "preferred")

    @property
    def outlines(self) -> dict[str, tuple[ZoneKind, Array]]:
        """Kind and corners (n, 2), map, m, of each zone."""
        every = {**self._kept_out, **self._slow, **self._preferred}
        return {name: (zone.kind, np.array(zone.corners)) for name, zone in every.items()}

    @property
    def keep_out(self) -> tuple[str, ...]:
        """Names of the zones to keep out of."""
        return tuple(self._kept_out)

    @property
    def slow(self) -> bool:
        """Whether there are slow zones."""
        return bool(self._slow)

    def blocked(self, grid: GridMap) -> NDArray[np.bool_] | None:
        """The cells (rows, columns) of which some part may lie in a zone to keep out of, or None.

        That the base's pose is not known exactly is part of it.
        """
        return _cells(grid, self._kept_out, DOUBT + math.sqrt(0.5) * grid.resolution)

    def factors(self, grid: GridMap, preferred: float) -> Field | None:
        """Cost factors (rows, columns), `preferred` in preferred zones; None without any."""
        cells = _cells(grid, self._preferred, 0.0)
        if cells is None:
            return None
        return np.where(cells, np.float32(preferred), np.float32(1.0))

    def entered(self, pose: Pose2D, discs: Array) -> str | None:
        """The first zone to keep out of that a footprint (discs (m, 3)) overlaps; None: none."""
        for name, zone in self._kept_out.items():
            if _room(zone, pose, discs) < -DOUBT:
                return name
        return None

    def border(self, pose: Pose2D) -> Array:
        """Points (n, 2), base frame, on the borders of zones that the base must not cross.

        The border of a zone in which the base's middle is does not count: it may leave.
        """
        here = np.array([[pose.x, pose.y]])
        found = [
            zone.border(SPACING) for zone in self._kept_out.values() if zone.distance(here)[0] > 0.0
        ]
        if not found:
            return np.zeros((0, 2))
        off = np.concatenate(found) - (pose.x, pose.y)
        c, s = math.cos(pose.yaw), math.sin(pose.yaw)
        return np.asarray(off @ np.array([[c, -s], [s, c]]))

    def limit(self, pose: Pose2D, discs: Array, deceleration: float) -> float:
        """The largest speed, m/s, at which slow zones are entered no faster than they allow.

        discs: the footprint (m, 3). deceleration: of the base, m/s2. Infinite without slow zones.
        """
        brake, least = BRAKE * deceleration, math.inf
        for zone in self._slow.values():
            assert zone.speed is not None
            ahead = max(_room(zone, pose, discs) - DOUBT, 0.0)
            lag = brake * REACTION
            fast = math.sqrt((zone.speed + lag) ** 2 + 2.0 * brake * ahead) - lag
            least = min(least, fast)
        return least

    def slowest(self, pose: Pose2D, reach: float) -> float:
        """The least limit of slow zones within `reach` m of a pose, m/s; infinite without any."""
        here = np.array([[pose.x, pose.y]])
        near = (
            zone.speed
            for zone in self._slow.values()
            if zone.speed is not None and zone.distance(here)[0] < reach
        )
        return min(near, default=math.inf)


def _of_kind(zones: Mapping[str, Zone], kind: ZoneKind) -> dict[str, Zone]:
    return {name: zone for name, zone in zones.items() if zone.kind == kind}


def _cells(grid: GridMap, zones: Mapping[str, Zone], margin: float) -> NDArray[np.bool_] | None:
    """The cells whose middle lies in a zone or up to `margin` m beside it; None without zones."""
    if not zones:
        return None
    every = np.ones(grid.cells.shape, dtype=np.bool_)
    centers = grid.centers(every)
    inside = np.zeros(len(centers), dtype=np.bool_)
    for zone in zones.values():
        low = np.min(zone.corners, axis=0) - margin
        high = np.max(zone.corners, axis=0) + margin
        near = ((centers >= low) & (centers <= high)).all(axis=1)
        inside[near] |= zone.distance(centers[near]) <= margin
    return inside.reshape(grid.cells.shape)


def _room(zone: Zone, pose: Pose2D, discs: Array) -> float:
    """Distance of a footprint at a pose from a zone, m; below 0 where they overlap."""
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    middles = discs[:, :2] @ np.array([[c, s], [-s, c]]) + (pose.x, pose.y)
    return float((zone.distance(middles) - discs[:, 2]).min())

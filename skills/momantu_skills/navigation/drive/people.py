"""Who walks about near the moving base: seen in scans, expected a second ahead, forgotten after."""

from __future__ import annotations

import math

import numpy as np

from momantu_bt.geometry import Array, Pose2D
from momantu_skills.navigation.map.costmap import Costmap
from momantu_skills.navigation.map.movers import RADIUS, Movers
from momantu_skills.navigation.map.sensing import Rays

FORGOTTEN = 0.15
"""How much farther around somebody who walks what was seen is forgotten, m: swinging arms."""
PREDICTIONS = (0.4, 0.8)
"""When the collision guard expects people at their predicted places, s from now."""
PREDICTED = 12
"""Points around each such place."""


class People:
    """Tells a costmap what moves, and the collision guard where it will be."""

    def __init__(self, costmap: Costmap) -> None:
        self._costmap, self._movers = costmap, Movers()

    def see(self, stamp: float, odom_from_base: Pose2D, map_from_odom: Pose2D, rays: Rays) -> None:
        """Tell the costmap what moves in a scan; where that was, nothing is any more."""
        self._movers.see(stamp, odom_from_base, rays)
        moving, left = self._movers.moving(stamp), self._movers.left
        if not len(moving) and not left:
            self._costmap.movers = moving
            return
        places = map_from_odom.apply(moving[:, :2])
        ways = map_from_odom.rotate(moving[:, 2:])
        self._costmap.movers = np.column_stack([places, ways])
        gone = map_from_odom.apply(np.array(left).reshape(-1, 2))
        self._costmap.forget(np.vstack([gone, places]), RADIUS + FORGOTTEN)

    def expected(self, map_from_base: Pose2D) -> Array:
        """Points (n, 2), base frame, around where what moves will be within a second."""
        moving = self._costmap.movers
        if not len(moving):
            return np.zeros((0, 2))
        turns = np.arange(PREDICTED) * (2.0 * math.pi / PREDICTED)
        ring = RADIUS * np.stack([np.cos(turns), np.sin(turns)], axis=1)
        at = [moving[:, :2] + moving[:, 2:] * t for t in PREDICTIONS]
        points = (np.concatenate(at)[:, None, :] + ring).reshape(-1, 2)
        return map_from_base.inverse().apply(points)

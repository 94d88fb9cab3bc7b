"""What the laser has met since a search began: every surface once, seen from where the base was."""

from __future__ import annotations

import math

import numpy as np

from momantu_bt.geometry import Array, Pose2D
from momantu_bt.lazy import lazily
from momantu_skills.navigation.map.sensing import SPREAD, Rays
from momantu_skills.navigation.matching.config import MatchingConfig

with lazily():
    from momantu_skills.navigation.matching import scan, submap, tracking


class Panorama:
    """Scans laid onto each other as mapping does, in the frame of the base's first pose.

    here: `first_from_base`. way: driven since the first scan, m. turned: likewise, rad.
    """

    def __init__(self) -> None:
        self.way = self.turned = 0.0
        self.here = Pose2D(0.0, 0.0, 0.0)
        self._config = MatchingConfig()
        self._surfaces = submap.Growing(self._config)
        self._scanned: Pose2D | None = None
        self._views: list[tuple[Pose2D, Rays]] = []
        self._seen = np.zeros(0, dtype=np.int64)

    def move(self, delta: Pose2D) -> None:
        """Carry the base on by odometry's `delta`, in the base's frame before the motion."""
        self.here = self.here @ delta
        self.way += math.hypot(delta.x, delta.y)
        self.turned += abs(delta.yaw)

    def add(self, rays: Rays) -> None:
        """Lay a scan onto the others; keep those of its beams that end where none did before."""
        points = scan.ScanPoints.from_rays(rays, self._config.longest)
        if self._scanned is not None:
            motion = self._scanned.inverse() @ self.here
            found = tracking.track(self._surfaces, self._scanned, motion, points, self._config)
            self.here = found.pose
        self._scanned = self.here
        self._surfaces.add(self.here, points)
        self._keep(rays)

    def _keep(self, rays: Rays) -> None:
        ends = self.here.apply(rays.points())
        cells = np.floor(ends / SPREAD).astype(np.int64)
        keys, first = np.unique(cells[:, 0] * 100_003 + cells[:, 1], return_index=True)
        new = np.sort(first[~np.isin(keys, self._seen)])
        self._seen = np.union1d(self._seen, keys)
        if len(new):
            beams = np.flatnonzero(rays.hit)[new]
            every = np.ones(len(beams), dtype=np.bool_)
            kept = Rays(rays.origin, rays.directions[beams], rays.ranges[beams], every)
            self._views.append((self.here, kept))

    def views(self) -> list[tuple[Pose2D, Rays]]:
        """The beams, each with `base_from_then`: where the base was, seen from where it is."""
        back = self.here.inverse()
        return [(back @ first_from_then, rays) for first_from_then, rays in self._views]

    def points(self, most: int) -> Array:
        """About `most` of the points (k, 2), in the base frame, m."""
        parts = [pose.apply(rays.points()) for pose, rays in self.views()]
        points = np.concatenate(parts) if parts else np.zeros((0, 2))
        step = max(1, len(points) // most)
        return np.ascontiguousarray(points[step // 2 :: step])

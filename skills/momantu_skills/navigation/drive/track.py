"""A track: a path of poses that the base follows, and how far it has come."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from momantu_bt.geometry import Array, Path, Pose2D, nearest_index, path_lengths, wrap_angle
from momantu_bt.lazy import lazily

with lazily():
    from momantu_skills.navigation.map import fields

if TYPE_CHECKING:
    from momantu_skills.navigation.map.costmap import Costmap
    from momantu_skills.navigation.map.fields import Field

SEARCH = 1.5
"""How far ahead along the path the base is looked for, m: not on a later part that passes by."""
ASTRAY = 0.5
"""Distance from the searched part, m, above which the base is looked for on the whole path."""
RETURNS = 0.6, 0.15
"""A path turns back where it comes within the second length, m, of a point more than the first, m,
before it."""
CORRIDOR = 0.1, 8.0, 6.0
"""Half width of the corridor along the path, m; extra cost per metre beside it; the largest cost
factor."""
RASTER = 0.04
"""Distance between the points with which a path is drawn on the costmap, m."""


class Track:
    """The path, and the index of the pose that the base has reached."""

    def __init__(self, path: Path, pose: Pose2D) -> None:
        """Begin at the pose of the path nearest to the base; at its start in doubt."""
        self.path = path
        self.along = path_lengths(path)
        self.at = nearest_index(path, pose, 0, SEARCH)
        if path[self.at].distance_to(pose) > ASTRAY:
            self.at = nearest_index(path, pose)

    @property
    def end(self) -> Pose2D:
        """The path's last pose."""
        return self.path[-1]

    @property
    def spacing(self) -> float:
        """Distance between two poses of the path, m, on average."""
        return self.along[-1] / max(1, len(self.path) - 1)

    def advance(self, pose: Pose2D) -> None:
        """Move on to the pose of the path that is nearest to the base, never back."""
        self.at = nearest_index(self.path, pose, self.at, SEARCH)

    @property
    def to_go(self) -> float:
        """Length of the path from the base's place on it, m."""
        return self.along[-1] - self.along[self.at]

    def window(self, length: float) -> int:
        """The last index within `length` m that is reached before the path turns back."""
        first = self.at
        last = first
        while last + 1 < len(self.path) and self.along[last + 1] - self.along[first] <= length:
            last += 1
        xy = np.array([(p.x, p.y) for p in self.path[first : last + 1]])
        way = np.array(self.along[first : last + 1])
        for k in range(1, len(xy)):
            before = way[:k] < way[k] - RETURNS[0]
            near = np.hypot(*(xy[:k][before] - xy[k]).T) < RETURNS[1]
            if near.any():
                met = float(way[:k][before][near][-1])
                turn = 0.5 * (met + float(way[k]))
                return first + int(np.searchsorted(way, turn))
        return last

    def heading(self, pose: Pose2D, ahead: float = 0.5) -> float:
        """The direction from the base to the point of the path `ahead` m farther on, rad."""
        for index in range(self.at, len(self.path)):
            point = self.path[index]
            if point.distance_to(pose) > ahead:
                return math.atan2(point.y - pose.y, point.x - pose.x)
        return pose.yaw

    def errors(self, pose: Pose2D) -> tuple[float, float]:
        """Distance from the path, m, positive to its left; turn away from it, positive right."""
        here = self.path[self.at]
        after = self.path[min(self.at + 1, len(self.path) - 1)]
        same = here.distance_to(after) < 1e-6
        yaw = here.yaw if same else math.atan2(after.y - here.y, after.x - here.x)
        left = (Pose2D(here.x, here.y, yaw).inverse() @ pose).y
        return left, wrap_angle(yaw - pose.yaw)

    def corridor(self, costmap: Costmap, last: int) -> Field:
        """Cost factors (rows, columns): 1 along the path up to `last`, more beside it."""
        half, extra, most = CORRIDOR
        points = _dense(np.array([(p.x, p.y) for p in self.path[self.at : last + 1]]))
        cells = np.floor((points - costmap.frame[:2]) / costmap.frame[2]).astype(np.int64)
        rows, columns = costmap.known.shape
        inside = (cells >= 0).all(axis=1) & (cells[:, 0] < columns) & (cells[:, 1] < rows)
        drawn = np.zeros((rows, columns), dtype=np.bool_)
        drawn[cells[inside, 1], cells[inside, 0]] = True
        away = fields.clearance(drawn, float(costmap.frame[2]))
        factors = np.minimum(1.0 + extra * np.maximum(away - half, 0.0), most)
        return np.asarray(factors, dtype=np.float32)


def _dense(points: Array) -> Array:
    steps = np.hypot(*np.diff(points, axis=0).T)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    at = np.linspace(0.0, along[-1], max(2, math.ceil(along[-1] / RASTER)))
    return np.stack([np.interp(at, along, points[:, k]) for k in (0, 1)], axis=1)

"""Where the camera has looked: what was in no picture is not known to be free."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import CameraImage

KEPT = 12
"""Pictures whose views are remembered: those of a search and of two looks at a grasp."""


@dataclass(frozen=True, eq=False)
class _Look:
    odom_from_camera: Transform
    intrinsics: Array
    shape: tuple[int, int]
    nearest: float

    def shows(self, points: Array) -> NDArray[np.bool_]:
        own = self.odom_from_camera.inverse().apply(points)
        z = np.maximum(own[:, 2], 1e-6)
        u = own[:, 0] / z * self.intrinsics[0, 0] + self.intrinsics[0, 2]
        v = own[:, 1] / z * self.intrinsics[1, 1] + self.intrinsics[1, 2]
        height, width = self.shape
        inside = (u >= 0) & (u < width) & (v >= 0) & (v < height)
        return np.asarray(inside & (own[:, 2] > self.nearest))


class Looks:
    """Where the camera has looked, in odom."""

    def __init__(self) -> None:
        self._looks: deque[_Look] = deque(maxlen=KEPT)

    def add(self, image: CameraImage, odom_from_camera: Transform, nearest: float) -> None:
        """Remember a picture's view. nearest: depth from which on the camera measures, m."""
        height, width = image.depth.shape
        look = _Look(odom_from_camera, image.intrinsics, (height, width), nearest)
        self._looks.append(look)

    def show(self, points: Array) -> NDArray[np.bool_]:
        """(n,) which points (n, 3) in odom lay in the view of one of the pictures."""
        shown = np.zeros(len(points), dtype=np.bool_)
        for look in self._looks:
            shown |= look.shows(points)
        return shown

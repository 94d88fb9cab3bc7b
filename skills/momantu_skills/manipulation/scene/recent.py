"""The newest pictures, for what is too small to be seen well in one of them."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.service import HeldObject, Snapshot

KEPT = 8
"""Newest pictures that are kept: those of two looks for an object, and of its grasp."""
CLOSELY = 2
"""Every n-th pixel in each direction gives a point."""

Seen = Callable[[Snapshot, HeldObject | None, int], Array]
"""Points (n, 3) in odom of a picture, without the robot and its load; the number: see CLOSELY."""


class RecentPictures:
    """Keeps the newest pictures, and computes their points when somebody asks."""

    def __init__(self, seen: Seen) -> None:
        """seen: computes the points of one picture."""
        self._seen = seen
        self._pictures: deque[tuple[Snapshot, HeldObject | None]] = deque(maxlen=KEPT)

    def add(self, snapshot: Snapshot, held: HeldObject | None) -> None:
        """Add a picture. held: what the hand held then."""
        self._pictures.append((snapshot, held))

    def points_since(self, stamp: float) -> Array:
        """Points (n, 3) in odom of the pictures that were taken after a time, s."""
        later = [each for each in self._pictures if each[0].image.stamp > stamp]
        points = [self._seen(snapshot, held, CLOSELY) for snapshot, held in later]
        return np.vstack([np.empty((0, 3)), *points])

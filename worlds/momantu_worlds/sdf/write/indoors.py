"""What of a floor is within a building: most directions meet a wall."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

AROUND = 7
"""Of eight directions from a point within a building, so many meet a wall."""


def inside(walls: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Cells from which walls are met in most directions. walls: (rows, columns) whether a wall."""
    rows, columns = walls.shape
    found = _met(walls)
    side = int(np.ceil(np.hypot(rows, columns))) + 2
    turn = cv2.getRotationMatrix2D((columns / 2, rows / 2), 45.0, 1.0)
    turn[:, 2] += (side / 2 - columns / 2, side / 2 - rows / 2)
    # thickened, so that no ray slips through a wall that is turned
    thick = cv2.dilate(walls.astype(np.uint8), np.ones((3, 3), np.uint8))
    turned = cv2.warpAffine(thick, turn, (side, side), flags=cv2.INTER_NEAREST)
    diagonal = cv2.warpAffine(
        _met(turned > 0).astype(np.uint8),
        turn,
        (columns, rows),
        flags=cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP,
    )
    return np.asarray((found + diagonal >= AROUND) & ~walls)


def _met(walls: NDArray[np.bool_]) -> NDArray[np.int64]:
    """How many of the four directions along rows and columns meet a wall."""
    flip = (slice(None), slice(None, None, -1))
    found = np.zeros(walls.shape, dtype=np.int64)
    for axis in (0, 1):
        view = walls.T if axis else walls
        ahead = np.logical_or.accumulate(view, axis=1).astype(np.int64)
        ahead += np.logical_or.accumulate(view[flip], axis=1)[flip]
        found += ahead.T if axis else ahead
    return found

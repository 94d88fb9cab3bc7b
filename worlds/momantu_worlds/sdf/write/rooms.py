"""Rooms of an imported world: where one ends and the next begins."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from momantu_worlds.sdf.write.free_floor import FreeFloor

STEP = 0.2
"""Cell size of the grid on which rooms are told apart, m."""
NECK = 0.7
"""A passage whose width is a smaller share of the narrower room's width separates two rooms."""
LEAST_ROOM = 2.0
"""Least area of a room, m2."""
_OPEN = -1.0


def rooms(floor: FreeFloor) -> NDArray[np.int32]:
    """(rows, columns) the room of each cell inside, counted from 1; 0: none.

    Rooms grow from where walls are farthest, and meet at the necks between them: a watershed of the
    distance to the walls (Meyer, 1994), in which a basin that is no wider than its neck is no room.
    """
    stride = max(1, round(STEP / floor.cell))
    within = floor.inside[::stride, ::stride]
    depth = np.where(within, floor.from_walls[::stride, ::stride], _OPEN)
    labels = _watershed(depth)
    counts = np.bincount(labels.reshape(-1))
    small = counts * (stride * floor.cell) ** 2 < LEAST_ROOM
    small[0] = True
    new = np.zeros(len(counts), dtype=np.int32)
    new[~small] = np.arange(1, int((~small).sum()) + 1)
    fine = np.repeat(np.repeat(new[labels], stride, axis=0), stride, axis=1)
    shape = floor.inside.shape
    return np.where(floor.inside, fine[: shape[0], : shape[1]], 0).astype(np.int32)


def _watershed(depth: NDArray[np.float64]) -> NDArray[np.int64]:
    """Basins of a depth, counted from 1; 0 where it is `_OPEN`."""
    rows, columns = depth.shape
    labels = np.zeros(depth.shape, dtype=np.int64)
    parent, peak = [0], [0.0]

    def root(label: int) -> int:
        while parent[label] != label:
            label = parent[label]
        return label

    order = np.argsort(-depth, axis=None, kind="stable")
    for index in order[: int((depth > _OPEN).sum())].tolist():
        row, column = divmod(index, columns)
        here = float(depth[row, column])
        near = {
            root(int(labels[r, c]))
            for r in range(max(0, row - 1), min(rows, row + 2))
            for c in range(max(0, column - 1), min(columns, column + 2))
            if labels[r, c]
        }
        if not near:
            parent.append(len(parent))
            peak.append(here)
            labels[row, column] = len(parent) - 1
            continue
        largest = min(near, key=lambda label: (-peak[label], label))
        for other in sorted(near - {largest}):
            if here > NECK * peak[other]:
                parent[other] = largest
        labels[row, column] = largest
    roots = np.array([root(label) for label in range(len(parent))])
    return np.asarray(roots[labels])

"""A short tour of a building that one knows: places from which its floor is seen, in a good order.

It is what an exploration is compared with. Places are chosen one by one, each the one that shows
most of what the others do not; their order is improved by exchanges until none helps. A shorter
tour may exist.
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from momantu_bt.geometry import Array

Mask = NDArray[np.bool_]
SEEN = 0.98
"""Share of the floor that the places show."""
APART = 0.6
"""Distance between the places that are compared, m."""
RAYS = 720
LONGEST = 25.0
"""How far a look counts, m."""
DIAGONAL = 2.0**0.5


def tour_length(
    walls: Mask, floor: Mask, stands: Mask, start: tuple[int, int], cell: float
) -> float:
    """Length, m, of a tour from `start` (row, column) whose places show `SEEN` of the floor.

    walls: (rows, columns), what ends a look. floor: what is to be seen. stands: where the base's
    middle may be; start is one of them. cell: m.
    """
    edge = max(1, round(APART / cell))
    rows, columns = np.nonzero(stands)
    _, first = np.unique(
        (rows // edge) * (stands.shape[1] // edge + 1) + columns // edge, return_index=True
    )
    candidates = [start, *zip(rows[first].tolist(), columns[first].tolist(), strict=True)]
    shown = np.array([_shown(walls, *at, LONGEST / cell)[floor] for at in candidates])
    chosen = _cover(shown)
    ways = _ways(stands, [candidates[number] for number in (0, *chosen)], cell)
    return _shortest(ways)


def _cover(shown: Mask) -> list[int]:
    """Numbers of the places (n, cells) that show most of what the first and the others do not."""
    left = ~shown[0]
    chosen: list[int] = []
    while left.mean() > 1.0 - SEEN:
        gains = shown[:, left].sum(axis=1)
        best = int(gains.argmax())
        if not gains[best]:
            break
        chosen.append(best)
        left &= ~shown[best]
    return chosen


def _ways(stands: Mask, places: list[tuple[int, int]], cell: float) -> Array:
    """(n, n) lengths of the shortest ways between places, m, from cell to cell of eight around."""
    numbers = np.full(stands.shape, -1)
    numbers[stands] = np.arange(int(stands.sum()))
    begins, ends, lengths = [], [], []
    for rows, columns in ((0, 1), (1, 0), (1, 1), (1, -1)):
        here = numbers[
            : stands.shape[0] - rows, max(0, -columns) : stands.shape[1] - max(0, columns)
        ]
        there = numbers[rows:, max(0, columns) : stands.shape[1] - max(0, -columns)]
        both = (here >= 0) & (there >= 0)
        begins.append(here[both])
        ends.append(there[both])
        lengths.append(np.full(int(both.sum()), cell * (DIAGONAL if rows and columns else 1.0)))
    graph = coo_array(
        (np.concatenate(lengths), (np.concatenate(begins), np.concatenate(ends))),
        shape=(int(stands.sum()),) * 2,
    ).tocsr()
    at = [int(numbers[place]) for place in places]
    return np.asarray(dijkstra(graph, directed=False, indices=at)[:, at])


def _shortest(ways: Array) -> float:
    """Length, m, of an order of all places from the first one: nearest first, then exchanges."""
    order, rest = [0], set(range(1, len(ways)))
    while rest:
        order.append(min(rest, key=lambda place: ways[order[-1], place]))
        rest.remove(order[-1])
    best, better = _length(ways, order), True
    while better:
        better = False
        for other in _exchanges(order):
            if _length(ways, other) < best - 1e-9:
                order, best, better = other, _length(ways, other), True
                break
    return best


def _exchanges(order: list[int]) -> list[list[int]]:
    """The same places with a piece turned round or with one put elsewhere; the first stays."""
    found = []
    for i in range(1, len(order)):
        found += [order[:i] + order[i:j][::-1] + order[j:] for j in range(i + 2, len(order) + 1)]
        without = order[:i] + order[i + 1 :]
        found += [[*without[:j], order[i], *without[j:]] for j in range(1, len(order)) if j != i]
    return found


def _length(ways: Array, order: list[int]) -> float:
    return float(ways[order[:-1], order[1:]].sum())


@numba.njit(cache=True)
def _shown(walls: Mask, row: int, column: int, longest: float) -> Mask:
    """(rows, columns): what rays from a cell pass before they meet a wall."""
    rows, columns = walls.shape
    shown = np.zeros(walls.shape, dtype=np.bool_)
    for k in range(RAYS):
        dy = np.sin(2.0 * np.pi * k / RAYS)
        dx = np.cos(2.0 * np.pi * k / RAYS)
        away = 0.0
        while away < longest:
            i = int(np.floor(row + 0.5 + dy * away))
            j = int(np.floor(column + 0.5 + dx * away))
            if not (0 <= i < rows and 0 <= j < columns) or walls[i, j]:
                break
            shown[i, j] = True
            away += 0.5
    return shown

"""Frontiers: where known floor meets unknown floor, and what a look from near them would show.

Yamauchi: A frontier-based approach for autonomous exploration (CIRA 1997); the gain of a look is
counted by rays, and fades with the way to it, as in Gonzalez-Banos and Latombe: Navigation
strategies for exploring indoor environments (IJRR 2002).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numba
import numpy as np
from numpy.typing import NDArray

from momantu_bt.formats.maps import FREE, OCCUPIED, UNKNOWN
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import frozen
from momantu_skills.navigation.map.costmap import Costmap
from momantu_skills.navigation.map.fields import Field
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.plan.planner import UNREACHED

APART = 0.5
"""Edge of the squares in which one frontier cell stands for all, m."""
FEWEST = 2
"""Fewest frontier cells in a square: single ones lie between the beams of far scans."""
FAR, NEAR, BESIDE = 4.0, 1.5, 0.7
"""How far from a frontier the base may stand to look at it, m. From afar a look costs less way; one
from beside it shows a nook that lies sideways. Where a look from afar was in vain, one from near
follows."""
SIGHT = 4.0
"""How far a look counts, m: farther beams lie too far apart."""
RAYS = 180
GROWN = 0.1
"""Distance from an obstacle within which nothing is looked at, m: no gap of 20 cm leads on."""
LEAST_GAIN = 0.2
"""Unknown floor that is worth a look, square metres."""
WORTH = 0.0004
"""Share of the known floor that is worth a metre of way: where 250 square metres are known, a nook
of one square metre is worth 10 m."""
SPARED = 0.02
"""Largest share of the floor that is left unknown because it is not worth the way."""
FADES = 5.0
"""Way over which a gain fades to a third, m: what is near is looked at before the base goes away
from it, and a room that is far away has to be large."""
SAME = 0.4
"""Distance within which a frontier counts as the same one, m."""


@dataclass(frozen=True, slots=True)
class Prospect:
    """A look at a frontier.

    frontier: one of its cells, map, m. view: where the base stands, map. gain: square metres of
    unknown floor in sight; way: to there, weighted metres.
    """

    frontier: tuple[float, float]
    view: Pose2D
    gain: float
    way: float

    @property
    def score(self) -> float:
        """The gain, faded by the way to it."""
        return self.gain * math.exp(-self.way / FADES)

    def worth(self, known: float) -> bool:
        """Whether so much unknown floor is worth the way where `known` square metres are known."""
        return self.gain >= WORTH * known * self.way


@dataclass(frozen=True, slots=True)
class Outlook:
    """All looks that are worth their way, best first, and the share of the floor that is known.

    If those that are not worth it would show more than `SPARED` of the floor, they are too.

    share: known floor over itself and the unknown floor that looks would show, 0..1; those too that
    are not worth their way.
    """

    prospects: tuple[Prospect, ...]
    share: float


def thick(costmap: Costmap, done: Sequence[tuple[float, float]] = ()) -> GridMap:
    """The map with its obstacles grown, which closes gaps between the hits of far beams.

    done: frontiers, map, m, that count as walls with what is near them.
    """
    cells = costmap.grid.cells.copy()
    cells[costmap.known_field < GROWN] = OCCUPIED
    for x, y in done:
        _wall_up(cells, costmap.grid, x, y)
    return replace(costmap.grid, cells=frozen(cells))


def _wall_up(cells: NDArray[np.uint8], grid: GridMap, x: float, y: float) -> None:
    """Make what is unknown near a point occupied."""
    row, column = grid.index(x, y)
    reach = math.ceil(SAME / grid.resolution)
    first_row, first_column = max(0, row - reach), max(0, column - reach)
    window = cells[first_row : row + reach + 1, first_column : column + reach + 1]
    rows, columns = np.indices(window.shape)
    away = np.hypot(rows + first_row - row, columns + first_column - column)
    window[(away * grid.resolution < SAME) & (window == UNKNOWN)] = OCCUPIED


def outlook(
    costmap: Costmap,
    cost: Field,
    stands: NDArray[np.bool_],
    done: Sequence[tuple[float, float]] = (),
    vain: Sequence[tuple[float, float]] = (),
) -> Outlook:
    """What is left to explore.

    cost: (rows, columns) weighted metres from the base, `UNREACHED` where it cannot get. stands:
    (rows, columns) where it has room for any heading. done: frontiers that are left out, with what
    is near and behind them. vain: those at which a look from afar was in vain.
    """
    grid = thick(costmap, done)
    views = np.where(stands, cost, UNREACHED)
    seen = np.zeros(grid.cells.shape, dtype=np.bool_)
    found = []
    for row, column in _squares(grid):
        place = grid.centre(row, column)
        prospect, shown = _prospect(grid, views, (row, column), far=not _among(place, vain))
        if prospect is not None:
            seen |= shown
            found.append(prospect)
    known = int(np.count_nonzero((costmap.grid.cells == FREE) & (cost < UNREACHED)))
    left = int(np.count_nonzero(seen))
    share = known / (known + left) if known + left else 0.0
    area = known * grid.resolution**2
    worth = [prospect for prospect in found if prospect.worth(area)]
    if not worth and share < 1.0 - SPARED:
        worth = found
    worth.sort(key=lambda prospect: (-prospect.score, prospect.frontier))
    return Outlook(tuple(worth), share)


def in_sight(grid: GridMap, x: float, y: float) -> list[tuple[float, float]]:
    """The frontiers, map, m, that are seen from a point of a `thick` map, up to `FAR` away."""
    row, column = grid.index(x, y)
    cells = _squares(grid)
    places = [grid.centre(*each) for each in cells]
    return [
        place
        for each, place in zip(cells, places, strict=True)
        if math.hypot(place[0] - x, place[1] - y) < FAR and _clear(grid.cells, row, column, *each)
    ]


def _among(place: tuple[float, float], others: Sequence[tuple[float, float]]) -> bool:
    """Whether a frontier is one of others, each of which stands for what is near it."""
    return any(math.dist(place, other) < SAME for other in others)


def _prospect(
    grid: GridMap, views: Field, cell: tuple[int, int], *, far: bool
) -> tuple[Prospect | None, NDArray[np.bool_]]:
    """The best look at a frontier cell, and the floor that it shows; None: none shows enough."""
    x, y = grid.centre(*cell)
    best: Prospect | None = None
    shown: NDArray[np.bool_] = np.zeros(grid.cells.shape, dtype=np.bool_)
    for reach in (FAR, NEAR, BESIDE) if far else (NEAR, BESIDE):
        at = _view(grid.cells, views, *cell, reach / grid.resolution, float(UNREACHED))
        if at[0] < 0:
            continue
        seen = np.zeros(grid.cells.shape, dtype=np.bool_)
        gain = gain_at(grid, *at, seen)
        vx, vy = grid.centre(*at)
        yaw = math.atan2(y - vy, x - vx) if at != cell else 0.0
        look = Prospect((x, y), Pose2D(vx, vy, yaw), gain, float(views[at]))
        if gain >= LEAST_GAIN and (best is None or look.score > best.score):
            best, shown = look, seen
    return best, shown


def gain_at(grid: GridMap, row: int, column: int, seen: NDArray[np.bool_] | None = None) -> float:
    """Square metres of unknown floor in sight of a cell of a `thick` map.

    seen: (rows, columns), in which the cells of that floor are marked.
    """
    marks = np.zeros(grid.cells.shape, dtype=np.bool_) if seen is None else seen
    cells = _gain(grid.cells, row, column, SIGHT / grid.resolution, marks)
    return float(cells * grid.resolution**2)


def _squares(grid: GridMap) -> list[tuple[int, int]]:
    """One frontier cell of each square that has enough of them: the one nearest to their mean."""
    cells = grid.cells
    rows, columns = np.nonzero((cells == FREE) & grid.beside(UNKNOWN))
    edge = round(APART / grid.resolution)
    square = (rows // edge) * (cells.shape[1] // edge + 1) + columns // edge
    chosen = []
    for each in np.unique(square):
        mine = np.nonzero(square == each)[0]
        if len(mine) < FEWEST:
            continue
        r, c = rows[mine], columns[mine]
        nearest = int(np.argmin((r - r.mean()) ** 2 + (c - c.mean()) ** 2))
        chosen.append((int(r[nearest]), int(c[nearest])))
    return chosen


@numba.njit(cache=True)
def _view(
    cells: NDArray[np.uint8], cost: Field, row: int, column: int, reach: float, unreached: float
) -> tuple[int, int]:
    """The cell that the base gets to first and from which a frontier cell is seen; (-1, -1)."""
    rows, columns = cells.shape
    r = math.ceil(reach)
    best = unreached
    found = (-1, -1)
    for i in range(max(0, row - r), min(rows, row + r + 1)):
        for j in range(max(0, column - r), min(columns, column + r + 1)):
            away = math.hypot(i - row, j - column)
            if away > reach or cost[i, j] >= best or cells[i, j] != FREE:
                continue
            if _clear(cells, i, j, row, column):
                best = cost[i, j]
                found = (i, j)
    return found


@numba.njit(cache=True)
def _clear(cells: NDArray[np.uint8], i: int, j: int, row: int, column: int) -> bool:
    """Whether only free cells lie between two."""
    steps = max(abs(row - i), abs(column - j))
    for k in range(1, steps):
        a = math.floor(i + 0.5 + (row - i) * k / steps)
        b = math.floor(j + 0.5 + (column - j) * k / steps)
        if cells[a, b] != FREE:
            return False
    return True


@numba.njit(cache=True)
def _gain(
    cells: NDArray[np.uint8], row: int, column: int, sight: float, seen: NDArray[np.bool_]
) -> float:
    """Area in cells of what is unknown along rays that end at what is occupied."""
    rows, columns = cells.shape
    area = 0.0
    for k in range(RAYS):
        angle = 2.0 * math.pi * k / RAYS
        dy = math.sin(angle)
        dx = math.cos(angle)
        away = 1.0
        while away < sight:
            i = math.floor(row + 0.5 + dy * away)
            j = math.floor(column + 0.5 + dx * away)
            if not (0 <= i < rows and 0 <= j < columns) or cells[i, j] == OCCUPIED:
                break
            if cells[i, j] == UNKNOWN:
                area += away * 2.0 * math.pi / RAYS
                seen[i, j] = True
            away += 1.0
    return area

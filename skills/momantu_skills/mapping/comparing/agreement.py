"""What two maps that are laid on each other agree in, and in what they do not."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, label

from momantu_bt.formats.maps import FREE, OCCUPIED, UNKNOWN
from momantu_bt.geometry import Array, Pose2D
from momantu_skills.mapping.comparing.side import Side

NEAR, SAME = 0.05, 0.10
"""Distances to the other map's surfaces within which a surface agrees, m."""
GAP = 0.15
"""Distance within which cells of one thing lie, m."""
SHORTEST = 0.15
"""Shorter things are not named, m: single cells at the edge of what was seen."""


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """The surface cells of one map, (n,) each, as the other map has them.

    near, same: within NEAR and SAME of a surface. missing: the other map is free there, and has no
    surface within SAME. The others it does not know.
    """

    near: NDArray[np.bool_]
    same: NDArray[np.bool_]
    missing: NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Thing:
    """A wall or a thing that one map has, and the other has free floor there.

    middle: in the first map, m. size: of its box along the first map's axes, m.
    """

    middle: tuple[float, float]
    size: tuple[float, float]

    @property
    def length(self) -> float:
        """The diagonal of its box, m."""
        return math.hypot(*self.size)


def judged(side: Side, other: Side, other_from_side: Pose2D) -> Judged:
    """How another map has the surfaces of one."""
    points = other_from_side.apply(side.points)
    distance = other.from_faces(points)
    same = distance <= SAME
    return Judged(distance <= NEAR, same, (other.cells_at(points) == FREE) & ~same)


def things(side: Side, missing: NDArray[np.bool_], a_from_side: Pose2D) -> list[Thing]:
    """What is missing in the other map, cells near each other together, the largest first."""
    rows, columns = np.nonzero(side.surface)
    mask = np.zeros(side.surface.shape, dtype=bool)
    mask[rows[missing], columns[missing]] = True
    reach = max(1, round(GAP / side.grid.resolution / 2))
    joined, _ = label(binary_dilation(mask, np.ones((2 * reach + 1,) * 2)), np.ones((3, 3)))
    numbers = joined[rows[missing], columns[missing]]
    points = a_from_side.apply(side.points[missing])
    half = side.grid.resolution
    found = [_thing(points[numbers == number], half) for number in np.unique(numbers)]
    named = [thing for thing in found if thing.length >= SHORTEST]
    return sorted(named, key=lambda thing: (-thing.length, thing.middle))


def _thing(points: Array, cell: float) -> Thing:
    low, high = points.min(axis=0) - cell / 2, points.max(axis=0) + cell / 2
    middle, size = (low + high) / 2, high - low
    return Thing((float(middle[0]), float(middle[1])), (float(size[0]), float(size[1])))


@dataclass(frozen=True, slots=True, eq=False)
class Overlaid:
    """Both maps' cells on the first one's raster, grown so that both lie on it.

    a, b: (rows, columns) of FREE, OCCUPIED, UNKNOWN. agrees_a, agrees_b: occupied cells that have
    an occupied one of the other map within SAME. origin: of the raster in the first map, m.
    """

    a: NDArray[np.uint8]
    b: NDArray[np.uint8]
    agrees_a: NDArray[np.bool_]
    agrees_b: NDArray[np.bool_]
    resolution: float
    origin: tuple[float, float]

    def area(self, mask: NDArray[np.bool_]) -> float:
        """Square metres of the cells in a mask."""
        return float(np.count_nonzero(mask) * self.resolution**2)

    @property
    def areas(self) -> dict[str, float]:
        """Square metres: known to both, to one alone, and where they contradict each other."""
        in_a, in_b = self.a != UNKNOWN, self.b != UNKNOWN
        return {
            "known_to_both_m2": self.area(in_a & in_b),
            "known_only_to_a_m2": self.area(in_a & ~in_b),
            "known_only_to_b_m2": self.area(in_b & ~in_a),
            "occupied_in_a_free_in_b_m2": self.area(
                (self.a == OCCUPIED) & (self.b == FREE) & ~self.agrees_a
            ),
            "free_in_a_occupied_in_b_m2": self.area(
                (self.a == FREE) & (self.b == OCCUPIED) & ~self.agrees_b
            ),
        }


def overlaid(a: Side, b: Side, a_from_b: Pose2D) -> Overlaid:
    """Lay the second map on the first one's raster."""
    cell = a.grid.resolution
    width, height = b.grid.size
    x, y = b.grid.origin
    corners = np.array([(x, y), (x + width, y), (x, y + height), (x + width, y + height)])
    reach = a_from_b.apply(corners)
    origin = np.array(a.grid.origin)
    end = origin + np.array(a.grid.size)
    before = np.ceil(np.maximum(0.0, (origin - reach.min(axis=0)) / cell - 1e-6)).astype(int)
    after = np.ceil(np.maximum(0.0, (reach.max(axis=0) - end) / cell - 1e-6)).astype(int)
    cells = np.pad(
        a.grid.cells,
        ((before[1], after[1]), (before[0], after[0])),
        constant_values=UNKNOWN,
    )
    low = origin - before * cell
    rows, columns = cells.shape
    along, up = np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)
    points = np.column_stack([along.ravel(), up.ravel()]) * cell + low
    in_b = a_from_b.inverse().apply(points)
    other = b.cells_at(in_b).reshape(cells.shape)
    return Overlaid(
        cells,
        other,
        (b.from_faces(in_b) <= SAME).reshape(cells.shape) & (cells == OCCUPIED),
        (a.from_faces(points) <= SAME).reshape(cells.shape) & (other == OCCUPIED),
        cell,
        (float(low[0]), float(low[1])),
    )

"""Things of cells that vote for the same middle, and what else their coordinates say is theirs.

Of a long thing that lies, cells far from its middle vote less exactly, so parts of it come out as
things of their own. Their coordinates tell where they are on it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from momantu_bt.categories import Symmetry
from momantu_bt.geometry import Array
from momantu_bt.world import seeded
from momantu_skills.perception.learned.instances import LEAST
from momantu_skills.perception.learned.solids import Solid, solid

AGREES = 0.026
"""Distance between a cell and where a thing has it up to which it is the thing's, m."""
GAINED = 0.08
"""Share of its cells that a thing has to gain to be fitted again."""
LEFT = 0.6
"""A thing that keeps less than this share of its cells was a part of another."""


class Cells(NamedTuple):
    """Cells that show things. points: (n, 3), m. coordinates: (k, n, 3) normalized, k answers.

    chances: (n, categories). of_handle: (n,) which show a handle.
    """

    points: Array
    coordinates: Array
    chances: Array
    of_handle: NDArray[np.bool_]


def claimed(
    cells: Cells, owner: NDArray[np.int64], categories: Mapping[str, Symmetry]
) -> dict[int, Solid]:
    """The things, by their numbers, of cells with their owners (n,), -1 of none.

    What explains most cells comes first, and claims those of others that agree with it; `owner` is
    changed accordingly.
    """
    things = {
        number: thing
        for number in range(int(owner.max()) + 1)
        if (thing := _fitted(cells, owner == number, number, categories)) is not None
    }
    worth = {number: thing.cells * thing.agreeing for number, thing in things.items()}
    settled: set[int] = set()
    for number in sorted(worth, key=lambda number: -worth[number]):
        if number not in things:
            continue
        settled.add(number)
        more = _agreeing(cells, things[number]) & ~np.isin(owner, list(settled))
        if int(more.sum()) < GAINED * things[number].cells:
            continue
        before = {each: int((owner == each).sum()) for each in np.unique(owner[more]).tolist()}
        owner[more] = number
        for each, count in before.items():
            mine = owner == each
            if each < 0 or each not in things:
                continue
            if int(mine.sum()) < max(LEAST, LEFT * count):
                del things[each]
                owner[mine] = -1
            else:
                _again(things, cells, owner, each, categories)
        _again(things, cells, owner, number, categories)
    return things


def _again(
    things: dict[int, Solid],
    cells: Cells,
    owner: NDArray[np.int64],
    number: int,
    categories: Mapping[str, Symmetry],
) -> None:
    """Fit a thing to the cells that it has now."""
    thing = _fitted(cells, owner == number, number, categories)
    if thing is not None:
        things[number] = thing


def _fitted(
    cells: Cells, mine: NDArray[np.bool_], number: int, categories: Mapping[str, Symmetry]
) -> Solid | None:
    random = seeded("similarity", number, int(mine.sum()))
    return solid(
        cells.points[mine],
        cells.coordinates[:, mine],
        cells.chances[mine],
        cells.of_handle[mine],
        random,
        categories,
    )


def _agreeing(cells: Cells, thing: Solid) -> NDArray[np.bool_]:
    """Which cells (n,) are where a thing has them, by all answers."""
    turn, shift = thing.frame_from_object.rotation, thing.frame_from_object.position
    scale = float(np.linalg.norm(thing.size))
    near = np.linalg.norm(cells.points - shift, axis=1) < scale / 2 + AGREES
    agrees = np.zeros(len(near), dtype=bool)
    there = scale * cells.coordinates[:, near] @ turn.T + shift
    away = np.linalg.norm(there - cells.points[near], axis=2)
    agrees[near] = away.max(axis=0) < AGREES
    return agrees

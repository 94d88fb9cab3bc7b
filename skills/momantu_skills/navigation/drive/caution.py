"""What plans keep away from if they can: unknown floor, and where the base was held up."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from momantu_skills.navigation.map.costmap import Costmap
    from momantu_skills.navigation.map.fields import Field

UNKNOWN_COST = 3.0
"""Cost of a metre of floor that a growing map does not know yet, relative to one that it does: a
known way is preferred unless it is much longer."""
AVOIDED = 0.8
"""Edge of the square around a point to avoid, m: as wide as a gap in which a base is held up."""
AVOIDED_COST = 50.0
"""Cost of a metre there, relative to others: a detour of some ten metres is preferred."""


class Caution:
    """Factors on the cost of each metre.

    unknown_cost: the factor of what a growing map does not know; inf: no way leads there.
    """

    def __init__(self, costmap: Costmap) -> None:
        self._costmap = costmap
        self._avoided: list[tuple[float, float]] = []
        self.unknown_cost = UNKNOWN_COST

    def avoid(self, x: float, y: float) -> None:
        """Lead ways round a point of the map, m, where there are others."""
        self._avoided.append((x, y))

    def factors(self) -> Field | None:
        """The factors (rows, columns), at least 1; None: 1 everywhere."""
        costmap = self._costmap
        if not costmap.grows and not self._avoided:
            return None
        factors = np.ones(costmap.known.shape, dtype=np.float32)
        if costmap.grows:
            factors[costmap.unknown] = self.unknown_cost
        for x, y in self._avoided:
            around = costmap.square(x, y, AVOIDED)
            factors[around] = np.maximum(factors[around], AVOIDED_COST)
        return factors

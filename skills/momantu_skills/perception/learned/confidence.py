"""How likely a found thing is right: the share of such things that are.

A logistic regression. Its factors are those of things that were found in pictures of the training
families that nothing was trained on; right is what overlaps a true thing of its category by half.
"""

from __future__ import annotations

import math

from momantu_skills.perception.learned.solids import Solid

BIAS = -5.7
"""Of a thing of USUAL cells of which nothing is sure."""
OF_CLASS, OF_AGREEING, OF_CELLS, OF_UPRIGHT = 6.7, 2.75, 1.7, 1.25
"""Factors: of the class's probability, of the share of coordinates that agree, of the logarithm of
its cells over USUAL, and of whether it is upright (a thing without an axis counts by half)."""
USUAL = 300.0
"""Cells of a usual thing."""


def chance(thing: Solid) -> float:
    """The chance, 0..1, that a found thing is right."""
    upright = float(thing.upright) if thing.has_axis else 0.5
    worth = (
        BIAS
        + OF_CLASS * thing.sure
        + OF_AGREEING * thing.agreeing
        + OF_CELLS * math.log(max(thing.cells, 1) / USUAL)
        + OF_UPRIGHT * upright
    )
    return 1.0 / (1.0 + math.exp(-worth))

"""Families of shapes for each of the usual categories; some are kept for testing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from momantu_bt.categories import USUAL
from momantu_worlds.labelled.families import bottles, bowls, boxes, cans, mugs
from momantu_worlds.labelled.shape import Draw, Maker, Shape, draw_look

CATEGORIES = tuple(USUAL)
"""All categories, in the order in which they are drawn."""
FAMILIES: Mapping[str, tuple[Mapping[str, Maker], Mapping[str, Maker]]] = MappingProxyType(
    {
        "bottle": (bottles.TRAINING, bottles.TESTING),
        "bowl": (bowls.TRAINING, bowls.TESTING),
        "can": (cans.TRAINING, cans.TESTING),
        "mug": (mugs.TRAINING, mugs.TESTING),
        "box": (boxes.TRAINING, boxes.TESTING),
    }
)
"""Category -> its families for training, and those for testing."""


def draw_shape(category: str, draw: Draw, *, testing: bool) -> Shape:
    """A shape of a random family. testing: of those that are never trained on."""
    kinds = FAMILIES[category][testing]
    family = list(kinds)[int(draw.integers(len(kinds)))]
    shape = kinds[family](draw, draw_look(draw))
    return replace(shape, category=category, family=family)

"""What heaps are made of: shapes of the usual categories, and of categories made from meshes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from momantu_bt.categories import USUAL, Symmetry
from momantu_worlds.labelled.families import CATEGORIES, draw_shape
from momantu_worlds.labelled.own import OwnCategory
from momantu_worlds.labelled.shape import Draw, Shape

OWN_SHARE = 0.45
"""Share of the things that are of categories made from meshes, if there are any."""


@dataclass(frozen=True, slots=True)
class Stock:
    """Where shapes are drawn from. testing: from those that are never trained on."""

    testing: bool
    own: tuple[OwnCategory, ...] = ()

    @property
    def categories(self) -> Mapping[str, Symmetry]:
        """All categories, and how a thing of each looks the same."""
        return {**USUAL, **{kind.name: kind.symmetry for kind in self.own}}

    def shape(self, draw: Draw) -> Shape:
        """A shape of any category."""
        if self.own and draw.random() < OWN_SHARE:
            return self.own[int(draw.integers(len(self.own)))].shape(draw, testing=self.testing)
        category = CATEGORIES[int(draw.integers(len(CATEGORIES)))]
        return draw_shape(category, draw, testing=self.testing)

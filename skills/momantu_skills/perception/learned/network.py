"""The network: from a crop of a picture to what each cell of it shows.

A U-Net with residual blocks. Cells are half as fine as the crop. It is small, because it runs on
one thread of a processor.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import torch
from torch import Tensor, nn

from momantu_bt.categories import USUAL, Symmetry
from momantu_skills.perception.learned.crops import CHANNELS

NOTHING = 0
"""Class of a cell that shows nothing. Those of the categories follow, then that of a handle."""
COORDINATES, OFFSETS = 3, 3
"""Numbers of a cell: where it is on its thing, and where the middle of its thing is."""
WIDTHS = (16, 32, 64, 96)
"""Channels of the levels, from fine to coarse."""
DEEP = 2
"""Blocks of the coarsest level after those on the way down."""
GROUP = 8
"""Channels that are normalised together: batches are small."""


class Block(nn.Module):
    """Two convolutions beside a shortcut."""

    def __init__(self, entering: int, leaving: int) -> None:
        super().__init__()
        self.first = nn.Conv2d(entering, leaving, 3, padding=1, bias=False)
        self.first_norm = nn.GroupNorm(leaving // GROUP, leaving)
        self.second = nn.Conv2d(leaving, leaving, 3, padding=1, bias=False)
        self.second_norm = nn.GroupNorm(leaving // GROUP, leaving)
        self.shortcut = nn.Conv2d(entering, leaving, 1) if entering != leaving else nn.Identity()

    def forward(self, x: Tensor) -> Tensor:
        """(n, entering, h, w) to (n, leaving, h, w)."""
        inner = torch.relu(self.first_norm(self.first(x)))
        inner = self.second_norm(self.second(inner))
        return torch.relu(inner + self.shortcut(x))


def classes_of(categories: Mapping[str, Symmetry]) -> tuple[str, ...]:
    """What a cell may show, by its class; a handle is part of a mug."""
    return ("nothing", *categories, "handle")


class Network(nn.Module):
    """See the module. categories: those that it tells apart."""

    def __init__(self, categories: Mapping[str, Symmetry] = USUAL) -> None:
        super().__init__()
        self.categories = dict(categories)
        self.classes = classes_of(categories)
        self.stem = nn.Conv2d(CHANNELS, WIDTHS[0], 5, stride=2, padding=2)
        self.down = nn.ModuleList(
            Block(before, after) for before, after in pairwise((WIDTHS[0], *WIDTHS))
        )
        self.more = nn.ModuleList(Block(width, width) for width in WIDTHS[1:])
        self.deep = nn.ModuleList(Block(WIDTHS[-1], WIDTHS[-1]) for _ in range(DEEP))
        self.narrow = nn.ModuleList(nn.Conv2d(coarse, fine, 1) for fine, coarse in pairwise(WIDTHS))
        self.up = nn.ModuleList(Block(width, width) for width in WIDTHS[:-1])
        self.head = nn.Conv2d(WIDTHS[0], len(self.classes) + COORDINATES + OFFSETS, 1)

    def forward(self, x: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Scores (n, classes, h/2, w/2), coordinates (n, 3, ...) and offsets (n, 3, ...).

        x: (n, CHANNELS, h, w); h and w are multiples of 16.
        """
        x = torch.relu(self.stem(x))
        levels = []
        for number, block in enumerate(self.down):
            if number:
                x = nn.functional.max_pool2d(x, 2)
            x = block(x)
            if number:
                x = self.more[number - 1](x)
            levels.append(x)
        for block in self.deep:
            x = block(x)
        for number in reversed(range(len(self.up))):
            finer = nn.functional.interpolate(self.narrow[number](x), scale_factor=2.0)
            x = self.up[number](finer + levels[number])
        out = self.head(x)
        scores, coordinates, offsets = out.split([len(self.classes), COORDINATES, OFFSETS], dim=1)
        return scores, coordinates, offsets

    def knowing(self, categories: Mapping[str, Symmetry]) -> Network:
        """A network for other categories, with all that this one has learned."""
        other, own = Network(categories), COORDINATES + OFFSETS
        learned, fresh = self.state_dict(), other.state_dict()
        for name in learned:
            if not name.startswith("head"):
                fresh[name] = learned[name]
                continue
            fresh[name][-own:] = learned[name][-own:]
            for new, shown in enumerate(other.classes):
                if shown in self.classes:
                    fresh[name][new] = learned[name][self.classes.index(shown)]
        other.load_state_dict(fresh)
        return other

"""The loss of a batch: classes, coordinates up to symmetry, offsets."""

from __future__ import annotations

import torch
from torch import Tensor, nn

COORDINATE_WEIGHT, OFFSET_WEIGHT = 12.0, 3.0
"""Weights beside that of the classes, at which all three fall alike."""
BEND, BEND_OFFSET = 0.03, 0.05
"""Errors up to which the losses are square: of coordinates, and of offsets in units of 0.1 m."""
OF_NOTHING, OF_HANDLE = 0.4, 1.5
"""Weights of these classes beside those of the categories; most cells show nothing."""


def loss(
    scores: Tensor, coordinates: Tensor, offsets: Tensor, truth: tuple[Tensor, ...]
) -> tuple[Tensor, Tensor, Tensor]:
    """Losses of classes, coordinates and offsets; their weighted sum is to be small.

    truth: classes, things, weights, coordinates and offsets, as `examples.alone` has them. Of
    equally good coordinates those count, for each thing as a whole, that are nearest.
    """
    classes, things, weights, valid, true_offsets = truth
    of_class = scores.new_ones(scores.shape[1])
    of_class[0], of_class[-1] = OF_NOTHING, OF_HANDLE
    by_class = weights * of_class[classes]
    each = nn.functional.cross_entropy(scores, classes, reduction="none")
    of_classes = (each * by_class).sum() / by_class.sum()
    n, y, x = torch.nonzero(things >= 0, as_tuple=True)
    if not len(n):
        return of_classes, coordinates.sum() * 0.0, offsets.sum() * 0.0
    said, told = coordinates[n, :, y, x], valid[n, :, :, y, x]
    apart = nn.functional.smooth_l1_loss(
        said[:, None].expand_as(told), told, reduction="none", beta=BEND
    ).sum(dim=2)
    which = n * (int(things.max()) + 1) + things[n, y, x]
    _, which = torch.unique(which, return_inverse=True)
    count = int(which.max()) + 1
    sums = apart.new_zeros(count, apart.shape[1]).index_add_(0, which, apart)
    cells = torch.bincount(which).to(apart.dtype)
    # a thing counts by the weights of its cells: neither do large ones rule, nor slivers
    counted = weights[n, y, x]
    share = apart.new_zeros(count).index_add_(0, which, counted)
    of_coordinates = (sums.min(dim=1).values / cells * share / share.sum()).sum()
    votes = nn.functional.smooth_l1_loss(
        offsets[n, :, y, x], true_offsets[n, :, y, x], reduction="none", beta=BEND_OFFSET
    )
    of_offsets = (votes.mean(dim=1) * counted).sum() / counted.sum()
    return of_classes, of_coordinates, of_offsets

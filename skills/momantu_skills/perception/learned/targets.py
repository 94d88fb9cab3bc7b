"""What the network shall say of each cell of a crop, from what is true of the picture.

Normalized coordinates are those of NOCS (Wang and others, 2019): a cell's place in its thing's own
frame over the diagonal of the thing's box. Where a thing looks the same from several sides, one of
these is chosen by a rule, or several are valid and the nearest one counts.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from momantu_bt.categories import Symmetry
from momantu_bt.geometry import Array, Transform

OFFSET_UNIT = 0.1
"""m; unit of the offsets to a thing's middle."""
VALID = 4
"""Most equally good coordinates of a thing."""
STANDING = 0.7
"""Cosine of the tilt up to which an axis counts as upright."""
HANDLE_CELLS = 8
"""Cells of a handle from which on it tells how a mug is turned."""
USUAL_CELLS, MOST_WEIGHT = 400, 2.5
"""Cells of a usual thing, and the largest factor by which cells of smaller ones count more."""
LYING_WEIGHT = 2.0
"""Factor for cells of round things that lie or stand on their head."""
OUTSIDE, OUTSIDE_LEAST = 1.04, 0.0015
"""A mug's cell belongs to its handle beyond this share of the radius and so many metres more."""


class Truth(NamedTuple):
    """One thing. size: (3,) m. number: in the picture."""

    number: int
    category: str
    symmetry: Symmetry
    level_from_object: Transform
    size: Array


@dataclass(frozen=True, slots=True, eq=False)
class Targets:
    """Of each cell (h, w). classes: as `classes_of`. things: index of the thing, or -1.

    weights: how much a cell counts, as it is one of few or of an uncommon kind. coordinates:
    (VALID, 3, h, w), offsets: (3, h, w); both valid where `things` is not -1.
    """

    classes: NDArray[np.int64]
    things: NDArray[np.int64]
    weights: NDArray[np.float32]
    coordinates: NDArray[np.float32]
    offsets: NDArray[np.float32]


def targets(
    points: NDArray[np.float32],
    numbers: NDArray[np.uint8],
    eye: float,
    truths: Sequence[Truth],
    named: Sequence[str],
) -> Targets:
    """Targets of cells with points (h, w, 3) in `level`, m, that show things by their numbers.

    eye: height of the camera, which is above the frame's origin, m. named: the classes.
    """
    shape = numbers.shape
    classes, things = np.zeros(shape, dtype=np.int64), np.full(shape, -1, dtype=np.int64)
    weights = np.ones(shape, dtype=np.float32)
    coordinates = np.zeros((VALID, 3, *shape), dtype=np.float32)
    offsets = np.zeros((3, *shape), dtype=np.float32)
    known = np.isfinite(points[..., 2])
    for index, truth in enumerate(truths):
        seen = numbers == truth.number
        of_category = named.index(truth.category)
        classes[seen] = of_category
        here = seen & known
        if not here.any():
            continue
        own = truth.level_from_object.inverse().apply(points[here])
        if truth.symmetry is Symmetry.HANDLE:
            out = np.hypot(own[:, 0], own[:, 1]) > OUTSIDE * truth.size[0] / 2 + OUTSIDE_LEAST
            classes[here] = np.where(out, named.index("handle"), of_category)
            turned = int(out.sum()) >= HANDLE_CELLS
        else:
            turned = False
        things[here] = index
        weights[seen] = _weight(int(here.sum()), truth)
        offsets[:, here] = ((truth.level_from_object.position - points[here]) / OFFSET_UNIT).T
        own = own / float(np.linalg.norm(truth.size))
        choices = _equal(own, truth, np.array([0.0, 0.0, eye]), turned=turned)
        for k in range(VALID):
            coordinates[k, :, here] = choices[k % len(choices)].astype(np.float32)
    return Targets(classes, things, weights, coordinates, offsets)


def _weight(cells: int, truth: Truth) -> float:
    """How much a cell of a thing counts: things shall count alike, be they small or large.

    Round things that do not stand count more: few lie, and of those the turn is harder to see.
    """
    no_axis = truth.symmetry in (Symmetry.BOX, Symmetry.NONE)
    standing = no_axis or truth.level_from_object.rotation[2, 2] > STANDING
    balance = math.sqrt(USUAL_CELLS / cells)
    return min(max(balance, 1.0 / MOST_WEIGHT), MOST_WEIGHT) * (1.0 if standing else LYING_WEIGHT)


def _equal(own: Array, truth: Truth, eye: Array, *, turned: bool) -> list[Array]:
    """Equally good coordinates (n, 3) of a thing.

    turned: a mug's handle is seen, which tells how it is turned about its axis.
    """
    up = truth.level_from_object.rotation[2]
    if truth.symmetry is Symmetry.BOX:
        own = own @ _upright(up).T
        quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        return [own @ np.linalg.matrix_power(quarter, k).T for k in range(4)]
    if turned or truth.symmetry is Symmetry.NONE:
        return [own]
    towards = truth.level_from_object.inverse().apply(eye)
    yaw = math.atan2(towards[1], towards[0])
    back = np.array(
        [[math.cos(yaw), math.sin(yaw), 0.0], [-math.sin(yaw), math.cos(yaw), 0.0], [0.0, 0.0, 1.0]]
    )
    own = own @ back.T
    if truth.symmetry is not Symmetry.ENDS:
        return [own]
    over = own * (1.0, -1.0, -1.0)
    if abs(up[2]) > STANDING:
        return [own if up[2] > 0.0 else over]
    return [own, over]


def _upright(up: Array) -> Array:
    """A rotation (3, 3) that names the axes of a box anew, so that z is the most upright one.

    up: (3,) the vertical direction in the box's own frame.
    """
    most = int(np.abs(up).argmax())
    z = np.zeros(3)
    z[most] = 1.0 if up[most] >= 0.0 else -1.0
    x = np.zeros(3)
    x[(most + 1) % 3] = 1.0
    return np.array([x, np.cross(z, x), z])

"""Pose and size of a thing, from where its cells are and where they are said to be on it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from momantu_bt.categories import USUAL, Symmetry
from momantu_bt.geometry import Array, Transform, rotation_between
from momantu_skills.perception.learned.similarity import fit

TOLERANCE = 0.012
"""Distance between a cell and where the fit has it up to which they agree, m."""
DIAGONALS = (0.05, 0.45)
"""Range of the diagonals of things' boxes, m."""
EXTREME = 96.0
"""Percentile of the cells' coordinates at a thing's end."""
STRAIGHT = math.radians(12.0)
"""Tilt up to which an axis is taken for upright: things rest on level surfaces."""
LYING = math.radians(30.0)
"""The same of a box, which has a flat side below however it was put down; and how far the axis of a
can or mug that lies may be from level. How what lies is turned is seen less well."""

UPRIGHT = 0.999
"""Cosine of the tilt up to which an axis is upright; nearly upright ones are made so."""


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A thing. frame_from_object: z is its axis, the origin the middle of its box.

    size: (3,) m, without a handle. cells: their number. sure: mean probability of its category.
    agreeing: share of the coordinates that its pose and size explain. told: symmetry of its
    category. handle: whether a mug's is seen, towards +x. chances: mean probability of each
    category. points: (n, 3) those that show it, m in the frame.
    """

    category: str
    frame_from_object: Transform
    size: tuple[float, float, float]
    cells: int
    sure: float
    handle: bool
    agreeing: float = 1.0
    told: Symmetry | None = None
    chances: Mapping[str, float] = field(default_factory=dict)
    points: Array = field(default_factory=lambda: np.empty((0, 3)))

    @property
    def symmetry(self) -> Symmetry:
        """From which sides it looks the same; that of the usual category unless `told`."""
        return self.told or USUAL.get(self.category, Symmetry.NONE)

    @property
    def has_axis(self) -> bool:
        """Whether it is round about z, but for a handle."""
        return self.symmetry not in (Symmetry.BOX, Symmetry.NONE)

    @property
    def upright(self) -> bool:
        """Whether its z axis is the vertical, up or down."""
        return abs(float(self.frame_from_object.rotation[2, 2])) > UPRIGHT

    def moved(self, target_from_frame: Transform) -> Solid:
        """The same in another frame that is level too."""
        return replace(
            self,
            frame_from_object=target_from_frame @ self.frame_from_object,
            points=target_from_frame.apply(self.points),
        )


def solid(
    points: Array,
    coordinates: Array,
    chances: Array,
    of_handle: NDArray[np.bool_],
    random: np.random.Generator,
    categories: Mapping[str, Symmetry] = USUAL,
) -> Solid | None:
    """The thing of some cells; None if no pose explains them.

    points: (n, 3) in a level frame, m. coordinates: (k, n, 3) normalized, k answers. chances:
    (n, len(categories)), of each. of_handle: (n,) which show a handle.
    """
    mean = chances.mean(axis=0)
    category = list(categories)[int(mean.argmax())]
    symmetry = categories[category]
    count, said = len(points), len(coordinates)
    coordinates = coordinates.reshape(-1, 3)
    points, of_handle = np.tile(points, (said, 1)), np.tile(of_handle, said)
    found = fit(coordinates, points, TOLERANCE, DIAGONALS, random)
    if found is None:
        return None
    body = coordinates[found.fitting & ~of_handle]
    if len(body) < 6:
        return None
    share = _extent(body, symmetry)
    size = found.scale * share
    turn = _straightened(found.rotation, symmetry)
    # the middle of all that agrees stays where it is
    middle = coordinates[found.fitting].mean(axis=0) * found.scale
    shift = points[found.fitting].mean(axis=0) - turn @ middle
    x, y, z = size.tolist()
    handle = symmetry is Symmetry.HANDLE and int(of_handle.sum()) >= 4 * said
    pose = Transform.from_rotation(turn, shift)
    agreeing = float(found.fitting.mean())
    sure = float(mean.max())
    of_each = dict(zip(categories, mean.tolist(), strict=True))
    return Solid(category, pose, (x, y, z), count, sure, handle, agreeing, symmetry, of_each)


def _extent(body: Array, symmetry: Symmetry) -> Array:
    """Extent (3,) of a thing over the diagonal of its box, from coordinates (n, 3) on it."""
    if symmetry in (Symmetry.BOX, Symmetry.NONE):
        half = np.percentile(np.abs(body), EXTREME, axis=0)
    else:
        wide = float(np.percentile(np.hypot(body[:, 0], body[:, 1]), EXTREME))
        half = np.array([wide, wide, float(np.percentile(np.abs(body[:, 2]), EXTREME))])
    return np.asarray(half / max(float(np.linalg.norm(half)), 1e-9))


def _straightened(rotation: Array, symmetry: Symmetry) -> Array:
    """The rotation with its most upright axis made upright, or that of a lying thing made level.

    Cans and mugs lie level, bottles on their shoulders need not. A thing that no symmetry keeps
    from lying otherwise stays as it is unless z is upright.
    """
    axes = (0, 1, 2) if symmetry is Symmetry.BOX else (2,)
    best = max(axes, key=lambda axis: abs(rotation[2, axis]))
    axis = rotation[:, best]
    tilt = math.acos(min(1.0, abs(float(axis[2]))))
    if tilt < (LYING if symmetry is Symmetry.BOX else STRAIGHT):
        return rotation_between(axis, np.array([0.0, 0.0, math.copysign(1.0, axis[2])])) @ rotation
    if symmetry in (Symmetry.ENDS, Symmetry.HANDLE) and tilt > math.pi / 2 - LYING:
        flat = np.array([axis[0], axis[1], 0.0])
        return rotation_between(axis, flat / np.linalg.norm(flat)) @ rotation
    return rotation

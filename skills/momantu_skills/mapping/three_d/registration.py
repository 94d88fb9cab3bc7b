"""Laying points on points: small_gicp's work, in one thread."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from momantu_bt.errors import MomantuError
from momantu_bt.geometry import Array, Transform
from momantu_bt.lazy import lazily

with lazily():
    import small_gicp

FEWEST = 100
"""Fewest points that can be laid on others."""


class RegistrationMissingError(MomantuError):
    """small_gicp is not installed; the message says what to do."""


def check_installed() -> None:
    """Check that points can be laid on points.

    Raises:
        RegistrationMissingError: small_gicp is not installed.
    """
    try:
        small_gicp.align  # noqa: B018 - the attribute loads the module
    except ImportError:
        raise RegistrationMissingError(
            "a map in three dimensions needs the package small_gicp: "
            "pip install 'momantu-bt[mapping3d]'"
        ) from None


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Thinned points with the lie of the surface around each, ready to be matched."""

    points: Any
    tree: Any
    size: int

    @classmethod
    def of(cls, points: Array, voxel: float, neighbours: int) -> Surface:
        """From points (n, 3), one for each voxel with this edge, m."""
        thinned, tree = small_gicp.preprocess_points(
            points, downsampling_resolution=voxel, num_neighbors=neighbours, num_threads=1
        )
        return cls(thinned, tree, int(thinned.size()))

    def positions(self) -> Array:
        """The thinned points (n, 3)."""
        return np.asarray(self.points.points())[:, :3].copy()


@dataclass(frozen=True, slots=True, eq=False)
class Match:
    """`target_from_source`; share: 0..1 of the source's points that lie near the target's."""

    pose: Transform
    share: float


def laid_on(target: Surface, source: Surface, guess: Transform, near: float) -> Match | None:
    """How `source` lies on `target`, from a guess of `target_from_source`; None: not found.

    near: distance within which points are paired, m.
    """
    if min(target.size, source.size) < FEWEST:
        return None
    found = small_gicp.align(
        target.points,
        source.points,
        target.tree,
        init_T_target_source=guess.matrix,
        registration_type="GICP",
        max_correspondence_distance=near,
        num_threads=1,
        max_iterations=30,
    )
    matrix = np.asarray(found.T_target_source)
    if not np.isfinite(matrix).all():
        return None
    return Match(Transform.from_matrix(matrix), found.num_inliers / source.size)

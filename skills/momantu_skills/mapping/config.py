"""Numbers of mapping, each with its unit and where it comes from."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class MappingConfig:
    """Settings of `Mapper`. Lengths in m, angles in rad.

    Measured on public logs of offices (180 and 361 beams, a scan every 0.7 and 1 m) and on
    simulated ones.
    """

    resolution: float = 0.05
    """Cell of a submap's likelihood grid, and of its points: one point is kept per cell."""
    search_resolution: float = 0.1
    """Cell of the grid in which a loop is searched."""
    longest: float = 25.0
    """Longer ranges are not matched: far points have no neighbours to make a line with."""
    submap_way: float = 10.0
    """A submap ends after this way; half a metre counts for each radian of turning."""
    submap_reach: float = 30.0
    """Half of a growing submap's edge: farther points are left out of it."""
    spread: float = 0.06
    """Standard deviation of an end point around a surface: noise, cell and beam width."""
    drift: float = 0.03
    """Standard deviation of odometry per step, and `drift_per_metre` more for each metre."""
    drift_per_metre: float = 0.1
    turn_drift: float = 0.02
    """The same for yaw, with parts for each metre and for each radian turned."""
    turn_drift_per_metre: float = 0.03
    turn_drift_per_radian: float = 0.1
    good_score: float = 0.75
    """Share of likelihood from which on a match is trusted as its geometry says; below it, the
    variance grows with the sixth power of what is lacking: a scan into a new room matches badly."""
    broken_score: float = 0.35
    """Score below which a submap ends: it is rigid only as long as its scans match."""
    loop_uncertainty: float = 1.5
    """How far a submap may be off without any drift, and `loop_drift` more per metre driven."""
    loop_drift: float = 0.05
    loop_farthest: float = 12.0
    """Largest distance, at the submap's middle, that is searched for a loop."""
    loop_candidates: int = 6
    """Submaps that a finished one is compared with, the nearest first."""
    loop_score: float = 0.45
    """Least share of likelihood of a loop before it is refined."""
    loop_share: float = 0.5
    """Least share of a submap's points that lie on the other's lines after that."""
    loop_misfit: float = 0.05
    """Largest root mean square distance of those points to the lines."""

"""Numbers of scan matching, each with its unit and where it comes from."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class MatchingConfig:
    """Settings of scans that are laid onto each other. Lengths in m, angles in rad.

    Measured on public logs of offices (180 and 361 beams, a scan every 0.7 and 1 m) and on
    simulated ones.
    """

    resolution: float = 0.05
    """Cell of a submap's likelihood grid, and of its points: one point is kept per cell."""
    search_resolution: float = 0.1
    """Cell of the grid in which a loop is searched."""
    longest: float = 25.0
    """Longer ranges are not matched: far points have no neighbours to make a line with."""
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

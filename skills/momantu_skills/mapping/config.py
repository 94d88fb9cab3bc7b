"""Numbers of mapping, each with its unit and where it comes from."""

from __future__ import annotations

from dataclasses import dataclass, field

from momantu_skills.navigation.matching.config import MatchingConfig


@dataclass(frozen=True, slots=True)
class MappingConfig:
    """Settings of `Mapper`, measured on the logs of `MatchingConfig`. Lengths in m."""

    matching: MatchingConfig = field(default_factory=MatchingConfig)
    submap_way: float = 10.0
    """A submap ends after this way; half a metre counts for each radian of turning."""
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

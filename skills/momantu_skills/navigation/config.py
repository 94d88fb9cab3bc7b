"""Tunables of localization and navigation; a site sets them under `services`."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class LocalizationConfig:
    """Adaptive Monte Carlo localization (Thrun, Burgard, Fox: Probabilistic Robotics, ch. 8).

    beams: of a scan that are weighed. hit_sigma: spread of hits about the map's surfaces, m: laser
    noise, the map's cells and small shifts of furniture together. random_share: share of beams that
    may be anything. trust: exponent on a scan's likelihood, as neighbouring beams are not
    independent. reach: distance at which a beam counts as unexplained, m.
    translation_noise, rotation_noise: standard deviations per metre and per radian of odometry;
    turn_per_metre: rad per m. move, turn: m and rad of odometry after which a scan is weighed.
    rest_scans: scans weighed at rest after a reset. rest_jitter: m (and rad) by which particles are
    moved at such a scan. particles: fewest and most. bin_size: m and rad of a KLD bin.
    kld_error, kld_quantile: the bound of KLD sampling and its normal quantile.
    slow, fast: decay per scan of augmented MCL's two averages. injected_most: largest share of
    random particles. global_spacing, global_headings: poses tried after `spread`, m and count.
    """

    beams: int = 60
    hit_sigma: float = 0.05
    random_share: float = 0.15
    trust: float = 0.3
    reach: float = 0.5
    translation_noise: float = 0.12
    rotation_noise: float = 0.12
    turn_per_metre: float = 0.06
    move: float = 0.12
    turn: float = 0.08
    rest_scans: int = 15
    rest_jitter: float = 0.006
    particles: tuple[int, int] = (400, 20_000)
    bin_size: tuple[float, float] = (0.10, 0.10)
    kld_error: float = 0.05
    kld_quantile: float = 2.33
    slow: float = 0.02
    fast: float = 0.2
    injected_most: float = 0.1
    global_spacing: float = 0.15
    global_headings: int = 72


@dataclass(frozen=True, slots=True)
class NavigationConfig:
    """Costmap, planner, controller and patience of `navigate`; lengths in m, times in s.

    period: of the controller; a whole number of ticks. speed: top speed, m/s.
    margin: least room between footprint and anything. comfort: decay length of the cost of
    nearness. near_speed: speed allowed where only `margin` is left; full speed at `far_clearance`.
    laser_reach, depth_reach: how far hits are kept. known_reach: hits this near to the map's own
    obstacles are the map's. depth_every: metres of driving between two looks at the depth picture.
    lowest_obstacle: height above the floor of what counts as an obstacle and not as floor; all
    between it and the robot's own height does.
    patience: time without getting nearer before recovery. blocked_patience: time that something
    may stand in the way. attempts: recoveries and approaches before giving up.
    """

    period: float = 0.1
    speed: float = 1.0
    margin: float = 0.03
    comfort: float = 0.12
    near_speed: float = 0.3
    far_clearance: float = 0.4
    laser_reach: float = 6.0
    depth_reach: float = 3.0
    known_reach: float = 0.08
    depth_every: float = 1.3
    lowest_obstacle: float = 0.06
    patience: float = 6.0
    blocked_patience: float = 3.0
    attempts: int = 4
    planning_time: float = 0.05


def configured(kind: type[T], parameters: Mapping[str, Any], owner: str) -> T:
    """A config with a site's parameters in it.

    Raises:
        ValueError: an unknown parameter, with the known ones.
    """
    known = [field.name for field in dataclasses.fields(kind)]  # type: ignore[arg-type]
    wrong = [name for name in parameters if name not in known]
    if wrong:
        raise ValueError(
            f"{owner} has no parameter {', '.join(wrong)}; parameters: {', '.join(known)}"
        )
    values = {k: tuple(v) if isinstance(v, list) else v for k, v in parameters.items()}
    return kind(**values)

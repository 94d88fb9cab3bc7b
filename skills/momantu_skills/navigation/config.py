"""Tunables of localization and navigation; a site sets them under `services`."""

from __future__ import annotations

from typing import Annotated, TypeAlias

from pydantic import AfterValidator, Field

from momantu_bt.descriptions.quantities import (
    Angle,
    AngularSpeed,
    LinearSpeed,
    Measured,
    Size,
    Time,
)
from momantu_bt.descriptions.tunables import Tunables

Count: TypeAlias = Annotated[int, Field(ge=1)]
Share: TypeAlias = Annotated[float, Field(ge=0.0, le=1.0)]
Weight: TypeAlias = Annotated[float, Field(ge=0.0)]
Spare: TypeAlias = Annotated[float, Measured("a length", ("m",), ge=0)]
"""A length that may be 0."""


def _rising(counts: tuple[int, int]) -> tuple[int, int]:
    if counts[0] > counts[1]:
        raise ValueError(f"expected the smaller number first; found {[*counts]}")
    return counts


Counts: TypeAlias = Annotated[tuple[Count, Count], AfterValidator(_rising)]
"""The fewest and the most of something."""


class LocalizationConfig(Tunables):
    """Adaptive Monte Carlo localization (Thrun, Burgard, Fox: Probabilistic Robotics, ch. 8)."""

    beams: Count = Field(default=60, description="beams of a scan that are weighed")
    hit_sigma: Size = Field(
        default=0.05,
        description="spread of hits about the map's surfaces: laser noise, the map's cells and "
        "small shifts of furniture together",
    )
    random_share: Share = Field(
        default=0.15, gt=0.0, description="share of beams that may be anything"
    )
    trust: Share = Field(
        default=0.3,
        gt=0.0,
        description="exponent on a scan's likelihood, as neighbouring beams are not independent",
    )
    reach: Size = Field(default=0.5, description="distance at which a beam counts as unexplained")
    translation_noise: Weight = Field(
        default=0.12, description="standard deviation of odometry, m per metre driven"
    )
    rotation_noise: Weight = Field(
        default=0.12, description="standard deviation of odometry, rad per radian turned"
    )
    turn_per_metre: Weight = Field(
        default=0.06, description="standard deviation of the heading, rad per metre driven"
    )
    move: Size = Field(default=0.12, description="way by odometry after which a scan is weighed")
    turn: Angle = Field(
        default=0.08, gt=0.0, description="turn by odometry after which a scan is weighed"
    )
    rest_scans: int = Field(
        default=15, ge=0, description="scans that are weighed at rest after a reset"
    )
    rest_jitter: Spare = Field(
        default=0.006,
        description="by which a scan at rest moves particles, and 0.7 times it in rad",
    )
    particles: Counts = Field(default=(400, 20_000), description="fewest and most particles")
    bin_size: tuple[Size, Angle] = Field(
        default=(0.10, 0.10), description="edge of a KLD bin, along the floor and in heading"
    )
    kld_error: Share = Field(default=0.05, gt=0.0, description="error bound of KLD sampling")
    kld_quantile: Weight = Field(
        default=2.33, description="normal quantile of KLD sampling's bound"
    )
    slow: Share = Field(default=0.02, description="decay per scan of augmented MCL's slow average")
    fast: Share = Field(default=0.2, description="decay per scan of augmented MCL's fast average")
    injected_most: Share = Field(default=0.1, description="largest share of random particles")
    global_spacing: Size = Field(
        default=0.15, description="distance between the places that are tried on the whole map"
    )
    global_headings: Count = Field(
        default=72, description="headings that are tried at each of them"
    )


class CriticWeights(Tunables):
    """What each critic of the controller counts, in metres still to go; see `critics`."""

    collision: Weight = Field(default=60.0, description="meeting something; the earlier, the worse")
    nearness: Weight = Field(default=1.0, description="being near something, times the speed there")
    haste: Weight = Field(default=25.0, description="speed above what the room allows, squared")
    heading: Weight = Field(
        default=0.7, description="looking away from the way to the goal, at the end"
    )
    smoothness: Weight = Field(default=0.05, description="changes of the turning speed, squared")


class ControllerConfig(Tunables):
    """Model predictive path integral control: how rollouts are drawn and weighed."""

    samples: int = Field(default=300, ge=3, le=10_000, description="rollouts per call")
    steps: int = Field(default=22, ge=2, le=200, description="steps of a rollout")
    step: Time = Field(default=0.1, gt=0.0, le=1.0, description="length of one")
    knots: int = Field(
        default=6,
        ge=2,
        description="instants at which noise is drawn; between them it is interpolated",
    )
    speed_noise: LinearSpeed = Field(default=0.30, description="standard deviation of speeds drawn")
    turn_noise: AngularSpeed = Field(default=0.60, description="standard deviation of turns drawn")
    temperature: float = Field(
        default=0.08, gt=0.0, description="of the rollouts' weights, in metres to the goal"
    )
    weights: CriticWeights = CriticWeights()


class PlannerConfig(Tunables):
    """What a metre costs the global planner."""

    nearness: Weight = Field(
        default=6.0, description="cost of a metre right beside something, over one in the open"
    )
    tight: float = Field(
        default=40.0,
        gt=0.0,
        description="cost of a metre where the footprint has no room to spare: only to leave such "
        "a place",
    )
    tight_by: Spare = Field(
        default=0.08,
        description="missing room that is still let through at `tight`, for starts and goals "
        "beside tables",
    )


class NavigationConfig(Tunables):
    """Costmap, planner, controller and patience of `navigate`."""

    period: Time = Field(default=0.1, ge=0.05, le=1.0, description="of the controller; whole ticks")
    speed: LinearSpeed = Field(default=1.0, le=5.0, description="top speed")
    margin: Size = Field(default=0.03, description="least room between footprint and anything")
    comfort: Size = Field(default=0.12, description="decay length of the cost of nearness")
    near_speed: LinearSpeed = Field(
        default=0.3, description="speed allowed where only `margin` is left"
    )
    far_clearance: Size = Field(default=0.4, description="room from which on full speed is allowed")
    laser_reach: Size = Field(default=6.0, description="how far hits of the laser are kept")
    depth_reach: Size = Field(
        default=3.0, description="how far points of the depth camera are kept"
    )
    known_reach: Size = Field(
        default=0.08, description="hits this near to the map's own obstacles are the map's"
    )
    depth_every: Size = Field(default=1.3, description="way between two looks at the depth picture")
    lowest_obstacle: Size = Field(
        default=0.06,
        description="height above the floor from which on something is an obstacle, up "
        "to the robot's own height",
    )
    patience: Time = Field(default=6.0, description="time without getting nearer before recovery")
    blocked_patience: Time = Field(
        default=3.0, description="how long something may stand in the way"
    )
    attempts: Count = Field(default=4, description="recoveries and approaches before giving up")
    planning_time: Time = Field(
        default=0.05, description="simulated time that planning a way takes"
    )
    controller: ControllerConfig = ControllerConfig()
    planner: PlannerConfig = PlannerConfig()

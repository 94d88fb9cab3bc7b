"""Tunables of localization and navigation; a site sets them under `services`."""

from __future__ import annotations

import math
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
from momantu_bt.geometry import Pose2D

Count: TypeAlias = Annotated[int, Field(ge=1)]
Share: TypeAlias = Annotated[float, Field(ge=0.0, le=1.0)]
Weight: TypeAlias = Annotated[float, Field(ge=0.0)]
Spare: TypeAlias = Annotated[float, Measured("a length", ("m",), ge=0)]
"""A length that may be 0."""
SLIP = 0.01
"""Standard deviation of odometry's way, m per radian turned."""


def _rising(counts: tuple[int, int]) -> tuple[int, int]:
    if counts[0] > counts[1]:
        raise ValueError(f"expected the smaller number first; found {[*counts]}")
    return counts


Counts: TypeAlias = Annotated[tuple[Count, Count], AfterValidator(_rising)]
"""The fewest and the most of something."""


class LocalizationConfig(Tunables):
    """Adaptive Monte Carlo localization (Thrun, Burgard, Fox: Probabilistic Robotics, ch. 8)."""

    beams: Count = Field(default=60, description="beams of a scan that are compared with the map")
    hit_sigma: Size = Field(
        default=0.05,
        description="spread of hits about the map's surfaces: laser noise, the map's cells and "
        "small shifts of furniture together",
    )
    random_share: Share = Field(
        default=0.15, gt=0.0, description="share of beams that may have any range (noise, people)"
    )
    trust: Share = Field(
        default=0.3,
        gt=0.0,
        description="exponent on a scan's likelihood, as neighbouring beams are not independent",
    )
    reach: Size = Field(
        default=0.5,
        description="distance from the map's surfaces above which a beam counts as unexplained",
    )
    translation_noise: Weight = Field(
        default=0.12, description="standard deviation of odometry, m per metre driven"
    )
    rotation_noise: Weight = Field(
        default=0.12, description="standard deviation of odometry, rad per radian turned"
    )
    turn_per_metre: Weight = Field(
        default=0.06, description="standard deviation of the heading, rad per metre driven"
    )
    move: Size = Field(default=0.12, description="distance driven after which a scan is used")
    turn: Angle = Field(default=0.08, gt=0.0, description="turn after which a scan is used")
    rest_scans: int = Field(
        default=15, ge=0, description="scans that are used at rest after a reset"
    )
    rest_jitter: Spare = Field(
        default=0.006,
        description="random motion of particles at each scan at rest; 0.7 times it in rad",
    )
    particles: Counts = Field(
        default=(400, 20_000), description="smallest and largest number of particles"
    )
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
        default=0.15, description="distance between the positions that are tried on the whole map"
    )
    global_headings: Count = Field(
        default=72, description="headings that are tried at each of them"
    )

    def odometry_deviation(self, motion: Pose2D) -> tuple[float, float, float]:
        """Standard deviations of a step by odometry: ahead, to the left, m, and of the yaw, rad.

        They grow with the way and the turn (the sampled odometry model, in one step).
        """
        way, turn = math.hypot(motion.x, motion.y), abs(motion.yaw)
        along = self.translation_noise * way + SLIP * turn
        return along, along / 2, self.rotation_noise * turn + self.turn_per_metre * way


class CriticWeights(Tunables):
    """Weights of the critics of the local controller, in metres of path length; see `critics`."""

    collision: Weight = Field(default=60.0, description="a collision; an early one costs more")
    nearness: Weight = Field(
        default=1.0, description="being near an obstacle, times the speed there"
    )
    haste: Weight = Field(
        default=25.0, description="speed above the limit for the clearance, squared"
    )
    heading: Weight = Field(
        default=0.7, description="heading away from the path to the goal, at the end"
    )
    smoothness: Weight = Field(default=0.05, description="changes of the turning speed, squared")


class ControllerConfig(Tunables):
    """Model predictive path integral control: how rollouts are sampled and weighted."""

    samples: int = Field(default=300, ge=3, le=10_000, description="rollouts per control period")
    steps: int = Field(default=22, ge=2, le=200, description="steps of a rollout")
    step: Time = Field(default=0.1, gt=0.0, le=1.0, description="duration of one step")
    knots: int = Field(
        default=6,
        ge=2,
        description="instants at which noise is drawn; between them it is interpolated",
    )
    speed_noise: LinearSpeed = Field(default=0.30, description="standard deviation of speeds drawn")
    turn_noise: AngularSpeed = Field(default=0.60, description="standard deviation of turns drawn")
    temperature: float = Field(
        default=0.08,
        gt=0.0,
        description="temperature of the rollouts' weights, in metres to the goal",
    )
    weights: CriticWeights = CriticWeights()


class PlannerConfig(Tunables):
    """What the global planner charges for a metre of path."""

    nearness: Weight = Field(
        default=6.0,
        description="extra cost of a metre beside an obstacle, relative to one in the open",
    )
    tight: float = Field(
        default=40.0,
        gt=0.0,
        description="cost of a metre without clearance for the footprint; used only to leave such "
        "a place",
    )
    tight_by: Spare = Field(
        default=0.08,
        description="missing clearance still allowed, at the cost `tight`, for starts and goals "
        "near tables",
    )
    preferred: float = Field(
        default=0.5,
        gt=0.0,
        le=1.0,
        description="cost of a metre in a preferred zone, relative to one elsewhere",
    )


class NavigationConfig(Tunables):
    """Parameters of `navigate`: costmap, planner, controller and time limits."""

    period: Time = Field(
        default=0.1, ge=0.05, le=1.0, description="control period; a whole number of ticks"
    )
    speed: LinearSpeed = Field(default=1.0, le=5.0, description="top speed")
    margin: Size = Field(
        default=0.03, description="least clearance between footprint and obstacles"
    )
    comfort: Size = Field(default=0.12, description="decay length of the cost of nearness")
    near_speed: LinearSpeed = Field(
        default=0.3, description="speed allowed where only `margin` is left"
    )
    far_clearance: Size = Field(
        default=0.4, description="clearance above which full speed is allowed"
    )
    laser_reach: Size = Field(
        default=6.0, description="range up to which laser hits enter the costmap"
    )
    depth_reach: Size = Field(
        default=3.0, description="range up to which points of the depth camera enter the costmap"
    )
    known_reach: Size = Field(
        default=0.08, description="hits nearer than this to the map's obstacles belong to those"
    )
    depth_every: Size = Field(default=1.3, description="distance driven between two depth pictures")
    lowest_obstacle: Size = Field(
        default=0.03,
        description="height above the floor above which points are obstacles, up "
        "to the robot's own height",
    )
    patience: Time = Field(default=6.0, description="time without progress before recovery")
    blocked_patience: Time = Field(
        default=3.0, description="time that an obstacle may block the path"
    )
    attempts: Count = Field(default=4, description="recoveries and approaches before giving up")
    planning_time: Time = Field(default=0.05, description="simulated duration of path planning")
    controller: ControllerConfig = ControllerConfig()
    planner: PlannerConfig = PlannerConfig()

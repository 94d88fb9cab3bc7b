"""Tunables of manipulation, each with its unit and the reason for its value."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from pydantic import Field

from momantu_bt.descriptions.quantities import Force, Size
from momantu_bt.descriptions.tunables import Tunables


class SceneConfig(Tunables):
    """How the planning scene processes depth pictures and decides whether an object is held."""

    voxel: Size = Field(
        default=0.02, description="edge of the cells: finer than gaps that the arm uses"
    )
    beyond_reach: Size = Field(
        default=0.35,
        description="distance beyond the robot's reach where elbow, hand or load may meet "
        "obstacles",
    )
    pixel_stride: int = Field(
        default=4,
        ge=1,
        description="every n-th pixel in each direction: 7 mm apart at 1 m, denser than the cells",
    )
    points_per_voxel: int = Field(
        default=2,
        ge=1,
        description="least points of an occupied cell; fewer are noise at depth edges",
    )
    thickness: Size = Field(
        default=0.04, description="assumed depth of objects behind their visible face"
    )
    robot_padding: Size = Field(
        default=0.03,
        description="margin around links and held object for removing them from a picture: depth "
        "noise, the camera's mounting error, and the lag between joints and picture",
    )
    surface_band: Size = Field(
        default=0.015, description="points within this height of a support surface belong to it"
    )
    closed_width: Size = Field(
        default=0.002,
        description="opening below which nothing is held: the thinnest wall is that of a bowl",
    )
    least_effort: Force = Field(
        default=3.0,
        description="closing force below which nothing is held: the sensor's noise is 1 N",
    )
    doubt: int = Field(
        default=4,
        ge=1,
        description="successive updates that must contradict holding: 0.2 s at 20 Hz, longer "
        "than any bounce",
    )


Hold: TypeAlias = Literal["any", "body", "rim", "handle"]
"""The part of an object by which a hand is to hold it; any: the body, or else rim or handle."""


class GraspConfig(Tunables):
    """How `pick` grasps where the tree says nothing of it."""

    by: Hold = Field(
        default="any",
        description="the part to hold an object by; any: the body, or else rim or handle",
    )


@dataclass(frozen=True)
class PlanningConfig:
    """How motions are planned. A search ends after a number of steps, never after a time."""

    step: float = 0.06
    """Distance between two collision checks of a motion, scaled rad; the hand then moves about 4
    cm."""
    margins: tuple[float, ...] = (0.012, 0.004)
    """Clearances that free motions keep from the surroundings, m, tried in turn. The first covers
    depth noise and half a cell's diagonal; the second is for narrow places. Where a spline rounds a
    corner, half of it is enough."""
    searches: int = 1500
    """Extensions of a search tree after which the search gives up: about 0.3 s."""
    attempts: int = 2
    """Number of searches; the quickest path is used."""
    rounding: tuple[float, ...] = (0.5, 0.25, 0.1)
    """Distances from a corner at which the spline may start to round it, rad, tried in turn; stops
    cost time."""
    range: float = 1.2
    """Longest branch of the search tree, scaled rad."""
    shortcut_rounds: int = 60
    """Number of random shortcuts that are tried on a path."""
    densify: float = 0.1
    """Distance between waypoints given to the spline, rad, so that it does not cut corners."""
    speed: float = 0.95
    """Share of the speed and acceleration limits that is used: drivers reject commands beyond the
    limits."""
    supposed: tuple[float | None, ...] = (0.04, 0.0, None)
    """How much nearer than on its maps what may be as tall as a wall is supposed to stand, m, tried
    in turn: the first covers errors of map and localization. None: it is no taller than seen."""
    careful_speed: float = 0.1
    """Fastest joint where something may stand that no sensor has seen, rad/s or m/s: a straight arm
    that swings at a hard wall with it pushes with 54 N before its motors feel it, and with 174 N at
    four times as fast (`benchmarks/contact_force.py`)."""
    sample: float = 0.04
    """Time between points of a timed trajectory, s."""
    tilt: float = 1.05
    """Largest tilt of a held object during a motion where possible, rad: 60 degrees."""


@dataclass(frozen=True)
class GazeConfig:
    """What makes a good view for a camera that the arm carries."""

    distances: tuple[float, float] = (0.45, 0.9)
    """Range of distances between camera and point, m: from nearer the view shows little of a table,
    from farther the measurement is worse."""
    distance_penalty: float = 6.0
    """Cost of a distance outside that range, s per m."""
    elevations: tuple[float, float] = (0.45, 1.1)
    """Range of downward angles of the view, rad: at smaller angles objects hide each other, at
    larger angles their sides are not visible."""
    elevation_penalty: float = 5.0
    """Cost of an angle outside that range, s per rad."""
    roll_penalty: float = 1.5
    """Cost of a picture rotated by 90 degrees, s: pictures are wider than high, and so are
    tables."""
    tilt_slack: float = 0.1
    """How much an object that is tilted already may tilt further, rad."""


@dataclass(frozen=True)
class HandConfig:
    """How the hand approaches, closes, measures contact and releases."""

    approach: float = 0.10
    """Length of the straight approach to a grasp, m."""
    near_margin: float = 0.006
    """Clearance from everything but the object while the hand is at it, m: error of the camera's
    mounting."""
    approach_speed: float = 0.10
    """Speed of the approach, m/s: slow, so that an unexpected contact pushes gently."""
    lift_speed: float = 0.15
    """Speed of lifting and retreating, m/s."""
    lower_speed: float = 0.03
    """Speed of lowering until contact, m/s: a delay of one tick is 1.5 mm, less than 50 N on a
    table."""
    above: float = 0.03
    """Height above a spot where lowering begins, m: height error of the surface and sag of the
    arm."""
    below: float = 0.025
    """Depth below a spot where lowering gives up, m."""
    contact_force: float = 5.0
    """Change of the vertical load that counts as contact, N: 20 sigma of the sensor."""
    force: float = 45.0
    """Closing force, N: holds 0.4 kg at a friction coefficient of 0.1 without damage."""
    margin: float = 0.03
    """Opening beyond the object's width when releasing next to other objects, m."""
    width_tolerance: float = 0.012
    """Largest difference between measured diameter and gripper opening in a good grasp, m."""
    close_time: float = 3.0
    """Time limit for closing or opening, s."""
    linear_step: float = 0.01
    """Distance between inverse kinematics solutions on a straight line, m."""
    old_pose: float = 60.0
    """Largest age of a pose that is still used for contact, s."""

"""Tunables of manipulation, each with its unit and reason."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import Field

from momantu_bt.descriptions.quantities import Force, Size
from momantu_bt.descriptions.tunables import Tunables


class SceneConfig(Tunables):
    """How the planning scene sees its surroundings and judges what is held."""

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
    width_tolerance: Size = Field(
        default=0.012,
        description="change of the opening above which the held object counts as lost",
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


@dataclass(frozen=True)
class PlanningConfig:
    """How motions are searched. A search ends after a count of steps, never by a clock."""

    step: float = 0.06
    """Scaled rad between two collision checks of a motion; the hand then moves about 4 cm."""
    margins: tuple[float, ...] = (0.012, 0.004)
    """m; clearance that transits keep from surroundings, tried in turn: depth noise and half a
    cell's corner; then what is left of it where things stand close. Half of it is enough where a
    spline rounds a corner."""
    searches: int = 1500
    """Growths of a search tree after which it gives up: about 0.3 s."""
    attempts: int = 2
    """Searches, of which the quickest path is taken."""
    rounding: tuple[float, ...] = (0.5, 0.25, 0.1)
    """rad around a corner in which the spline may cut it, tried in turn: stops cost time."""
    range: float = 1.2
    """Scaled rad; longest branch of the tree."""
    shortcut_rounds: int = 60
    """Random shortcuts tried on a path."""
    densify: float = 0.1
    """rad between waypoints given to the spline, so that it does not cut corners."""
    speed: float = 0.95
    """Share of the speed and acceleration limits that is used: drivers refuse what passes them."""
    sample: float = 0.04
    """s between points of a timed trajectory."""
    tilt: float = 1.05
    """rad; how far a held object may lean while it is moved, where that is possible: 60 degrees."""


@dataclass(frozen=True)
class GazeConfig:
    """What makes a good view from a camera that the arm carries."""

    distances: tuple[float, float] = (0.45, 0.9)
    """m between camera and point: nearer shows little of a table, farther measures it worse."""
    distance_penalty: float = 6.0
    """s per m nearer or farther."""
    elevations: tuple[float, float] = (0.45, 1.1)
    """rad by which the view goes down: flatter, things hide each other; steeper, they lose their
    sides."""
    elevation_penalty: float = 5.0
    """s per rad flatter or steeper."""
    roll_penalty: float = 1.5
    """s for a picture that lies on its side: it is wider than high, and so are tables."""
    tilt_slack: float = 0.1
    """rad by which what leans already may lean more."""


@dataclass(frozen=True)
class HandConfig:
    """How the hand approaches, closes, feels and lets go."""

    approach: float = 0.10
    """m of straight line before a grasp."""
    near_margin: float = 0.006
    """m; clearance from all but the object while the hand is at it: camera mounting error."""
    approach_speed: float = 0.10
    """m/s on that line: what is met by error is pushed softly."""
    lift_speed: float = 0.15
    """m/s when lifting and retreating."""
    lower_speed: float = 0.03
    """m/s when lowering until contact: one tick late is 1.5 mm, below 50 N on a table."""
    above: float = 0.03
    """m above a spot where lowering begins: height error of the surface and sag of the arm."""
    below: float = 0.025
    """m below a spot where lowering gives up."""
    contact_force: float = 5.0
    """N; change of the vertical load that counts as contact: 20 sigma of the sensor."""
    force: float = 45.0
    """N; closing force: holds 0.4 kg at a friction of 0.1, dents nothing."""
    margin: float = 0.03
    """m wider than the object when letting go beside other things."""
    width_tolerance: float = 0.012
    """m between measured diameter and gripper opening that a good grasp may show."""
    close_time: float = 3.0
    """s after which closing or opening is given up."""
    linear_step: float = 0.01
    """m between solved poses on a straight line."""
    old_pose: float = 60.0
    """s; a pose older than this is not touched."""

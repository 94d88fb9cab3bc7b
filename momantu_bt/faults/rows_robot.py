"""Faults at the robot's boundary: sensors that err, actuators that do not obey."""

from __future__ import annotations

from math import inf, pi
from typing import Any

from momantu_bt.faults.kind import FaultKind, Variant, Where, lasting, number, word

LOOKING = ("detect_object", "find_apriltag", "detect_plane", "pick")
DRIVING = ("navigate+2 s", "relocalize")
REACHING = ("pick/reaching", "reset_pose", "place")
SEEN_NOTHING = frozenset(
    {"OBJECT_NOT_FOUND", "SURFACE_NOT_SEEN", "TAG_NOT_SEEN", "PLANE_NOT_FOUND", "NOTHING_THERE"}
)
GRASPED_NOTHING = frozenset({"GRASP_MISSED", "SLIPPED", "NOT_HOLDING", "NOTHING_HELD", "LOST"})
NO_WAY = frozenset({"PATH_BLOCKED", "NO_PATH", "NO_PROGRESS", "GOAL_BLOCKED"})
LOST_ITSELF = frozenset({"NOT_LOCALIZED", "NO_PROGRESS"})
SENSOR = frozenset({"SENSOR_DEAD"})
ARM = frozenset({"ARM_STUCK", "NO_PLAN", "OUT_OF_VIEW"})
_FOR_GOOD = (Variant("for=inf", recoverable=False),)


def _kind(name: str, doc: str, *parameters: Any, **more: Any) -> FaultKind:
    component, _, mode = name.partition(".")
    return FaultKind(component, mode, doc, Where.ROBOT, parameters=parameters, **more)


CAMERA = (
    _kind(
        "camera.dead",
        "No camera answers.",
        lasting(5.0),
        phases=LOOKING,
        notice=5.0,
        recoverable=True,
        reasons=SENSOR,
        variants=_FOR_GOOD,
    ),
    _kind(
        "camera.frozen",
        "Every camera gives its last picture again and again, with new stamps.",
        lasting(5.0),
        phases=LOOKING,
        notice=10.0,
        recoverable=True,
        reasons=SENSOR | SEEN_NOTHING | GRASPED_NOTHING | {"STALE_POSE"},
        variants=_FOR_GOOD,
    ),
    _kind(
        "camera.dark",
        "The light is out: colours are dimmed, depth is as good as ever.",
        number("gain", 0.05, None, "what is left of each colour", 0.0, 1.0),
        lasting(10.0),
        phases=("find_apriltag", *LOOKING),
        notice=10.0,
        recoverable=True,
        reasons=SENSOR | SEEN_NOTHING,
        variants=_FOR_GOOD,
    ),
    _kind(
        "camera.biased",
        "Depth is wrong by a factor and an offset.",
        number("scale", 1.01, None, "measured depth over true depth", 0.5, 2.0),
        number("offset", 0.0, "m", "added to the depth", -1.0, 1.0),
        lasting(inf),
        phases=(),
        notice=60.0,
        recoverable=True,
        reasons=SEEN_NOTHING | GRASPED_NOTHING | ARM | {"NO_GRASP", "NO_CONTACT", "TOPPLED"},
    ),
    _kind(
        "camera.noisier",
        "Depth and colour are noisier than they should be.",
        number("depth", 0.004, None, "sigma of depth z is this times z squared, 1/m", 0.0, 1.0),
        number("color", 15.0, None, "sigma in grey levels of 255", 0.0, 255.0),
        lasting(inf),
        phases=(),
        notice=60.0,
        recoverable=True,
        reasons=SEEN_NOTHING | GRASPED_NOTHING | {"NO_GRASP", "NO_FREE_SPOT"},
    ),
    _kind(
        "camera.shifted",
        "Every camera is turned on its mount, and nobody has calibrated it since.",
        number("turn", 0.015, "rad", "by how much, about an axis that the seed chooses", 0.0, pi),
        lasting(inf),
        phases=(),
        notice=60.0,
        recoverable=True,
        reasons=SEEN_NOTHING | GRASPED_NOTHING | ARM | {"NO_GRASP", "NO_CONTACT", "TOPPLED"},
    ),
)

LASER = (
    _kind(
        "laser.dead",
        "No laser answers.",
        lasting(5.0),
        phases=DRIVING,
        notice=2.0,
        recoverable=True,
        reasons=SENSOR | LOST_ITSELF,
        variants=_FOR_GOOD,
    ),
    _kind(
        "laser.stuck",
        "Every laser gives its last ranges again and again, with new stamps.",
        lasting(5.0),
        phases=DRIVING,
        notice=5.0,
        recoverable=True,
        reasons=SENSOR | LOST_ITSELF | NO_WAY,
        variants=_FOR_GOOD,
    ),
    _kind(
        "laser.blocked",
        "Something sticks to the lens: the beams of a sector give the least range.",
        number("at", 0.0, "rad", "the sector's middle; 0 is ahead, the left is positive", -pi, pi),
        number("width", 0.5, "rad", "of the sector", 0.0, 2 * pi),
        lasting(20.0),
        phases=DRIVING,
        notice=10.0,
        recoverable=True,
        reasons=SENSOR | LOST_ITSELF | NO_WAY,
        variants=_FOR_GOOD,
    ),
)

ODOMETRY = (
    _kind(
        "odometry.slip",
        "The wheels slip: odometry counts another way and other turns than the base makes.",
        number("scale", 1.3, None, "reported motion over true motion", 0.0, 5.0),
        lasting(5.0),
        phases=DRIVING,
        notice=20.0,
        recoverable=True,
        reasons=LOST_ITSELF | NO_WAY | SEEN_NOTHING,
    ),
    _kind(
        "odometry.bias",
        "Odometry turns by itself while the base moves.",
        number("rate", 0.05, "rad/s", "of the turn that is none", -1.0, 1.0),
        lasting(20.0),
        phases=DRIVING,
        notice=30.0,
        recoverable=True,
        reasons=LOST_ITSELF | NO_WAY | SEEN_NOTHING,
    ),
)

BASE = (
    _kind(
        "base.stuck",
        "The base does not move, whatever it is told.",
        lasting(10.0),
        phases=DRIVING,
        notice=30.0,
        recoverable=True,
        reasons=NO_WAY | LOST_ITSELF,
        variants=_FOR_GOOD,
    ),
    _kind(
        "base.slow",
        "The base drives and turns slower than it is told.",
        number("factor", 0.5, None, "true speed over commanded speed", 0.0, 1.0),
        lasting(inf),
        phases=DRIVING,
        notice=60.0,
        recoverable=True,
        reasons=NO_WAY | LOST_ITSELF | {"TIMEOUT"},
    ),
    _kind(
        "base.offset",
        "The base pulls to one side while it drives.",
        number("curvature", 0.2, None, "turn per way, rad/m; the left is positive", -5.0, 5.0),
        lasting(inf),
        phases=DRIVING,
        notice=60.0,
        recoverable=True,
        reasons=NO_WAY | LOST_ITSELF,
    ),
)

ARM_ROWS = (
    _kind(
        "arm.stuck",
        "The arm does not move, whatever it is told.",
        lasting(5.0),
        phases=REACHING,
        notice=5.0,
        recoverable=True,
        reasons=ARM,
        variants=_FOR_GOOD,
    ),
    _kind(
        "arm.slow",
        "The arm follows its trajectories slower than it is told.",
        number("factor", 0.7, None, "true speed over commanded speed", 0.05, 1.0),
        lasting(inf),
        phases=("pick", "reset_pose", "place"),
        notice=10.0,
        recoverable=True,
        reasons=ARM | {"TIMEOUT"},
    ),
    _kind(
        "arm.offset",
        "A joint is elsewhere than it says, since its encoder was mounted anew.",
        number("by", 0.03, "rad", "what the joint reports too much", -1.0, 1.0),
        word("joint", "", "which joint; else the arm's first one that turns"),
        lasting(inf),
        phases=(),
        notice=60.0,
        recoverable=True,
        reasons=ARM | GRASPED_NOTHING | {"NO_GRASP", "NO_CONTACT", "TOPPLED"},
    ),
)

GRIPPER = (
    _kind(
        "gripper.weak",
        "The gripper presses with less force than it is told.",
        number("factor", 0.3, None, "true force over commanded force", 0.001, 1.0),
        lasting(inf),
        phases=("pick",),
        notice=30.0,
        recoverable=True,
        reasons=GRASPED_NOTHING | {"OBJECT_NOT_FOUND"},
    ),
    _kind(
        "gripper.stuck",
        "The fingers stay as they are, whatever they are told.",
        lasting(10.0),
        phases=("pick", "place"),
        notice=15.0,
        recoverable=True,
        reasons=frozenset({"GRIPPER_STUCK", "ARM_STUCK", "GRASP_MISSED", "NOT_OPEN"}),
        variants=_FOR_GOOD,
    ),
    _kind(
        "gripper.slips",
        "The fingers lose their force until they are opened again.",
        number("force", 0.3, "N", "what is left", 0.001, 100.0),
        phases=("Put/navigate+2 s", "after-pick+3 s", "place"),
        notice=5.0,
        recoverable=False,
        reasons=GRASPED_NOTHING | {"OBJECT_NOT_FOUND"},
    ),
)

KINDS: tuple[FaultKind, ...] = (*CAMERA, *LASER, *ODOMETRY, *BASE, *ARM_ROWS, *GRIPPER)

"""Faults at the robot's boundary: sensors that err, actuators that do not obey."""

from __future__ import annotations

from functools import partial
from math import inf, pi

from momantu_bt.activity import Activity
from momantu_bt.failure import SENSOR_DEAD, TIMEOUT
from momantu_bt.fault_kind import (
    FaultKind,
    Trigger,
    Variant,
    Where,
    fault_kind,
    lasting,
    number,
    word,
)
from momantu_bt.robot import ARM
from momantu_bt.symptom import Symptom

GRASP = Trigger(Activity.GRASP)
MARKER = Trigger(Activity.FIND_MARKER)
LOOKING = (
    Trigger(Activity.FIND_OBJECT),
    MARKER,
    Trigger(Activity.MEASURE_SURFACE),
    GRASP,
    Trigger(Activity.LOOK),
)
DRIVING = (Trigger(Activity.DRIVE), Trigger(Activity.LOCALIZE))
ARM_MOVES = (Trigger(Activity.MOVE_ARM), Trigger(Activity.SET_DOWN))
SENSOR = (SENSOR_DEAD,)
UNSEEN = frozenset({Symptom.NOT_SEEN})
MISJUDGED = frozenset({Symptom.NOT_SEEN, Symptom.NOT_HELD})
"""Symptoms of an object that is not where it is seen, or is not seen at all."""
OFF_TARGET = frozenset(
    {Symptom.ARM_OFF_COURSE, Symptom.NO_GRASP, Symptom.NO_CONTACT, Symptom.TOPPLED}
)
"""Symptoms of a hand that misses the place it should reach."""
ASTRAY = frozenset({Symptom.NOT_LOCALIZED, Symptom.WAY_BLOCKED})
"""Symptoms of a base that is not where the robot believes."""
_FOR_GOOD = (Variant("for=inf", recoverable=False),)

_kind = partial(fault_kind, place=Where.ROBOT)
_base = partial(_kind, actuator="base")
_arm = partial(_kind, actuator=ARM)
_gripper = partial(_kind, actuator="gripper")

CAMERA = (
    _kind(
        "camera.dead",
        "No camera answers.",
        lasting(5.0),
        begins=LOOKING,
        notice=5.0,
        recoverable=True,
        codes=SENSOR,
        variants=_FOR_GOOD,
    ),
    _kind(
        "camera.frozen",
        "Every camera gives its last picture again and again, with new stamps.",
        lasting(5.0),
        begins=LOOKING,
        notice=10.0,
        recoverable=True,
        symptoms=MISJUDGED | {Symptom.OUTDATED},
        codes=SENSOR,
        variants=_FOR_GOOD,
    ),
    _kind(
        "camera.dark",
        "The light is out: colours are dimmed, depth is as good as ever.",
        number("gain", 0.05, None, "what is left of each colour", 0.0, 1.0),
        lasting(10.0),
        begins=(MARKER, *(moment for moment in LOOKING if moment != MARKER)),
        notice=10.0,
        recoverable=True,
        symptoms=UNSEEN,
        codes=SENSOR,
        variants=_FOR_GOOD,
    ),
    _kind(
        "camera.biased",
        "Depth is wrong by a factor and an offset.",
        number("scale", 1.01, None, "measured depth over true depth", 0.5, 2.0),
        number("offset", 0.0, "m", "added to the depth", -1.0, 1.0),
        lasting(inf),
        begins=(),
        notice=60.0,
        recoverable=True,
        symptoms=MISJUDGED | OFF_TARGET,
    ),
    _kind(
        "camera.noisier",
        "Depth and colour are noisier than they should be.",
        number("depth", 0.004, None, "sigma of depth z is this times z squared, 1/m", 0.0, 1.0),
        number("color", 15.0, None, "sigma in grey levels of 255", 0.0, 255.0),
        lasting(inf),
        begins=(),
        notice=60.0,
        recoverable=True,
        symptoms=MISJUDGED | {Symptom.NO_GRASP, Symptom.NO_ROOM},
    ),
    _kind(
        "camera.shifted",
        "Every camera is turned on its mount and has not been calibrated since.",
        number("turn", 0.015, "rad", "by how much, about an axis that the seed chooses", 0.0, pi),
        lasting(inf),
        begins=(),
        notice=60.0,
        recoverable=True,
        symptoms=MISJUDGED | OFF_TARGET,
    ),
)

LASER = (
    _kind(
        "laser.dead",
        "No laser answers.",
        lasting(5.0),
        begins=DRIVING,
        notice=2.0,
        recoverable=True,
        symptoms={Symptom.NOT_LOCALIZED},
        codes=SENSOR,
        variants=_FOR_GOOD,
    ),
    _kind(
        "laser.stuck",
        "Every laser gives its last ranges again and again, with new stamps.",
        lasting(5.0),
        begins=DRIVING,
        notice=5.0,
        recoverable=True,
        symptoms=ASTRAY,
        codes=SENSOR,
        variants=_FOR_GOOD,
    ),
    _kind(
        "laser.blocked",
        "Something sticks to the lens: the beams of a sector give the least range.",
        number("at", 0.0, "rad", "the sector's middle; 0 is ahead, the left is positive", -pi, pi),
        number("width", 0.5, "rad", "of the sector", 0.0, 2 * pi),
        lasting(20.0),
        begins=DRIVING,
        notice=10.0,
        recoverable=True,
        symptoms=ASTRAY,
        codes=SENSOR,
        variants=_FOR_GOOD,
    ),
)

ODOMETRY = (
    _kind(
        "odometry.slip",
        "The wheels slip: odometry counts another way and other turns than the base makes.",
        number("scale", 1.3, None, "reported motion over true motion", 0.0, 5.0),
        lasting(5.0),
        begins=DRIVING,
        notice=20.0,
        recoverable=True,
        symptoms=ASTRAY | UNSEEN,
    ),
    _kind(
        "odometry.bias",
        "Odometry turns by itself while the base moves.",
        number("rate", 0.05, "rad/s", "of the false turn", -1.0, 1.0),
        lasting(20.0),
        begins=DRIVING,
        notice=30.0,
        recoverable=True,
        symptoms=ASTRAY | UNSEEN,
    ),
)

BASE = (
    _base(
        "base.stuck",
        "The base does not move, whatever the command.",
        lasting(10.0),
        begins=DRIVING,
        notice=30.0,
        recoverable=True,
        symptoms=ASTRAY,
        variants=_FOR_GOOD,
    ),
    _base(
        "base.slow",
        "The base drives and turns slower than commanded.",
        number("factor", 0.5, None, "true speed over commanded speed", 0.0, 1.0),
        lasting(inf),
        begins=DRIVING,
        notice=60.0,
        recoverable=True,
        symptoms=ASTRAY,
        codes={TIMEOUT},
    ),
    _base(
        "base.offset",
        "The base pulls to one side while it drives.",
        number("curvature", 0.2, None, "turn per way, rad/m; the left is positive", -5.0, 5.0),
        lasting(inf),
        begins=DRIVING,
        notice=60.0,
        recoverable=True,
        symptoms=ASTRAY,
    ),
    _base(
        "base.wheel",
        "One wheel is larger than believed: the base pulls to a side, and odometry misses it.",
        number("factor", 1.02, None, "true radius over the believed one", 0.8, 1.25),
        word("side", "left", "which wheel: left or right"),
        lasting(inf),
        begins=(),
        notice=60.0,
        recoverable=True,
        symptoms=ASTRAY | UNSEEN,
    ),
)

ARM_ROWS = (
    _arm(
        "arm.stuck",
        "The arm does not move, whatever the command.",
        lasting(5.0),
        begins=(Trigger(Activity.REACH), *ARM_MOVES),
        notice=5.0,
        recoverable=True,
        symptoms={Symptom.ARM_OFF_COURSE},
        variants=_FOR_GOOD,
    ),
    _arm(
        "arm.slow",
        "The arm follows its trajectories slower than commanded.",
        number("factor", 0.7, None, "true speed over commanded speed", 0.05, 1.0),
        lasting(inf),
        begins=(GRASP, *ARM_MOVES),
        notice=10.0,
        recoverable=True,
        symptoms={Symptom.ARM_OFF_COURSE},
        codes={TIMEOUT},
    ),
    _arm(
        "arm.offset",
        "A joint is elsewhere than it reports: its encoder was mounted wrongly.",
        number("by", 0.03, "rad", "what the joint reports too much", -1.0, 1.0),
        word("joint", "", "which joint; else the arm's first one that turns"),
        lasting(inf),
        begins=(),
        notice=60.0,
        recoverable=True,
        symptoms={Symptom.NOT_HELD} | OFF_TARGET,
    ),
)

GRIPPER = (
    _gripper(
        "gripper.weak",
        "The gripper presses with less force than commanded.",
        number("factor", 0.3, None, "true force over commanded force", 0.001, 1.0),
        lasting(inf),
        begins=(GRASP,),
        notice=30.0,
        recoverable=True,
        symptoms={Symptom.NOT_HELD, Symptom.OBJECT_GONE},
    ),
    _gripper(
        "gripper.stuck",
        "The fingers do not move, whatever the command.",
        lasting(10.0),
        begins=(GRASP, Trigger(Activity.SET_DOWN)),
        notice=15.0,
        recoverable=True,
        symptoms={Symptom.HAND_STUCK},
        variants=_FOR_GOOD,
    ),
    _gripper(
        "gripper.slips",
        "The fingers lose their force until they are opened again.",
        number("force", 0.3, "N", "what is left", 0.001, 100.0),
        begins=(Trigger(Activity.GRASP, after=3.0), Trigger(Activity.SET_DOWN)),
        notice=5.0,
        recoverable=False,
        symptoms={Symptom.NOT_HELD, Symptom.OBJECT_GONE},
    ),
)

KINDS: tuple[FaultKind, ...] = (*CAMERA, *LASER, *ODOMETRY, *BASE, *ARM_ROWS, *GRIPPER)

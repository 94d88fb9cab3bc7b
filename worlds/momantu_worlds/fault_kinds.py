"""Kinds of faults of the surroundings; `momantu_worlds.sapien.faults` implements them.

This module holds only what is needed to list them, so that listing loads no simulator.
"""

from __future__ import annotations

from functools import partial
from math import inf, pi

from momantu_bt.activity import Activity
from momantu_bt.fault_kind import (
    FaultKind,
    Trigger,
    Variant,
    Where,
    count,
    fault_kind,
    lasting,
    number,
)
from momantu_bt.symptom import Symptom

GRASP = Trigger(Activity.GRASP)
FIND_MARKER = Trigger(Activity.FIND_MARKER)
SEEING = (
    Trigger(Activity.FIND_OBJECT),
    FIND_MARKER,
    Trigger(Activity.MEASURE_SURFACE),
    Trigger(Activity.LOOK),
)
DRIVING = (Trigger(Activity.DRIVE), Trigger(Activity.LOCALIZE))
BEFORE_GRASP = (Trigger(Activity.FIND_OBJECT, after=0.0), GRASP)
CARRYING = (Trigger(Activity.GRASP, after=3.0), Trigger(Activity.SET_DOWN))
MISSED = (
    Symptom.NOT_SEEN,
    Symptom.NOT_HELD,
    Symptom.OUTDATED,
    Symptom.NO_GRASP,
    Symptom.ARM_WAY_BLOCKED,
)
"""Symptoms when an object is at another pose than the one at which it was seen."""

_kind = partial(fault_kind, place=Where.WORLD)

KINDS: tuple[FaultKind, ...] = (
    _kind(
        "camera.misses_object",
        "The goal's item cannot be seen.",
        count("frames", 3, "for how many pictures", least=1),
        begins=SEEING,
        notice=20.0,
        recoverable=True,
        symptoms={Symptom.NOT_SEEN},
    ),
    _kind(
        "camera.phantom",
        "An item like the goal's is seen on the same surface where none is.",
        count("frames", 3, "for how many pictures", least=1),
        begins=SEEING,
        notice=60.0,
        recoverable=True,
        symptoms=MISSED,
    ),
    _kind(
        "robot.kidnapped",
        "The robot is put elsewhere on free floor.",
        number("distance", 1.0, "m", "how far", 0.0),
        number("turn", 1.0, "rad", "how much it is turned", 0.0, pi),
        begins=DRIVING,
        notice=20.0,
        recoverable=True,
        symptoms={Symptom.NOT_LOCALIZED, Symptom.WAY_BLOCKED},
    ),
    _kind(
        "doorway.blocked",
        "Something stands in the doorway ahead.",
        lasting(20.0),
        begins=DRIVING,
        notice=30.0,
        recoverable=True,
        symptoms={Symptom.WAY_BLOCKED},
        variants=(Variant("for=inf", recoverable=False),),
    ),
    _kind(
        "person.in_way",
        "Somebody stands 1 m in front of the robot.",
        lasting(10.0),
        begins=DRIVING,
        notice=5.0,
        recoverable=True,
        symptoms={Symptom.WAY_BLOCKED},
        variants=(Variant("for=inf", recoverable=False),),
    ),
    _kind(
        "person.in_doorway",
        "Somebody stops in the doorway ahead.",
        lasting(20.0),
        begins=DRIVING,
        notice=30.0,
        recoverable=True,
        symptoms={Symptom.WAY_BLOCKED},
    ),
    _kind(
        "person.follows",
        "Somebody walks a pace behind the robot.",
        lasting(30.0),
        begins=DRIVING,
        notice=30.0,
        recoverable=True,
        symptoms={Symptom.WAY_BLOCKED},
    ),
    _kind(
        "person.reaches_over",
        "Somebody holds an arm before the goal's item, and draws it back from the robot.",
        lasting(15.0),
        begins=BEFORE_GRASP,
        notice=60.0,
        recoverable=True,
        symptoms=MISSED,
    ),
    _kind(
        "object.moved",
        "The goal's item is moved on its surface.",
        number("distance", 0.08, "m", "how far", 0.0),
        begins=BEFORE_GRASP,
        notice=60.0,
        recoverable=True,
        symptoms=MISSED,
    ),
    _kind(
        "object.knocked_over",
        "The goal's item is laid on its side.",
        begins=BEFORE_GRASP,
        notice=60.0,
        recoverable=False,
        symptoms=MISSED,
    ),
    _kind(
        "object.removed",
        "The goal's item is taken away.",
        begins=BEFORE_GRASP,
        notice=60.0,
        recoverable=False,
        symptoms=MISSED,
    ),
    _kind(
        "object.lost",
        "What is carried is taken out of the hand and laid on the floor.",
        begins=CARRYING,
        notice=5.0,
        recoverable=False,
        symptoms={Symptom.NOT_HELD, Symptom.OBJECT_GONE},
    ),
    _kind(
        "place.occupied",
        "Boxes stand on the free spots beside the marker.",
        count("free", 1, "how many spots within the goal's distance are left"),
        begins=(FIND_MARKER, Trigger(Activity.MEASURE_SURFACE)),
        notice=90.0,
        recoverable=True,
        symptoms={
            Symptom.NO_ROOM,
            Symptom.CANNOT_SET_DOWN,
            Symptom.ARM_WAY_BLOCKED,
            Symptom.MARKER_NOT_SEEN,
        },
        variants=(Variant("free=0", recoverable=False),),
    ),
    _kind(
        "tag.covered",
        "Something lies on the tag.",
        lasting(inf),
        begins=(FIND_MARKER,),
        notice=90.0,
        recoverable=False,
        symptoms={Symptom.MARKER_NOT_SEEN},
        variants=(Variant("for=20 s", recoverable=True),),
    ),
    _kind(
        "tag.wrong_id",
        "The tag bears another number.",
        count("id", 7, "which one"),
        begins=(),
        notice=90.0,
        recoverable=False,
        symptoms={Symptom.MARKER_NOT_SEEN},
    ),
)

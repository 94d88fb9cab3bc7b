"""Faults in the site that the robot gets; the world does not change."""

from __future__ import annotations

from functools import partial
from math import pi

from momantu_bt.fault_kind import FaultKind, Variant, Where, fault_kind, number, word
from momantu_bt.symptom import Symptom

_kind = partial(fault_kind, place=Where.SITE)

KINDS: tuple[FaultKind, ...] = (
    _kind(
        "map.wrong",
        "The floor plan lacks a piece of wall, or lies elsewhere than the places on it.",
        number("missing", 1.5, "m", "length of the stretch of wall that is not on it", 0.0),
        number("shift", 0.0, "m", "how far the plan lies off, in a direction of the seed's", 0.0),
        begins=(),
        notice=60.0,
        recoverable=True,
        symptoms={Symptom.NOT_LOCALIZED, Symptom.WAY_BLOCKED, Symptom.NOT_SEEN},
        variants=(Variant("missing=0, shift=50 cm", recoverable=False),),
    ),
    _kind(
        "table.height",
        "The site gives surfaces as higher than they are.",
        number("by", 0.05, "m", "how much too high; below 0: too low", -1.0, 1.0),
        word("surface", "", "which one; else all"),
        begins=(),
        notice=60.0,
        recoverable=True,
        symptoms={
            Symptom.NOT_SEEN,
            Symptom.NO_CONTACT,
            Symptom.ARM_WAY_BLOCKED,
            Symptom.NO_GRASP,
            Symptom.CANNOT_SET_DOWN,
        },
    ),
    _kind(
        "table.moved",
        "Surfaces stand elsewhere than the site and its floor plan say.",
        number("distance", 0.5, "m", "how far, in a direction of the seed's", 0.0, 2.0),
        number("turn", 0.0, "rad", "how much they are turned; the left is positive", -pi, pi),
        word("surface", "", "which one; else all"),
        begins=(),
        notice=60.0,
        recoverable=True,
        symptoms={
            Symptom.NOT_SEEN,
            Symptom.WAY_BLOCKED,
            Symptom.ARM_WAY_BLOCKED,
            Symptom.NO_GRASP,
            Symptom.NO_ROOM,
            Symptom.CANNOT_SET_DOWN,
        },
    ),
)

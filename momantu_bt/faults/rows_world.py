"""Faults of the surroundings, and of what the robot is told about them."""

from __future__ import annotations

from math import inf, pi
from typing import Any

from momantu_bt.faults.kind import FaultKind, Variant, Where, count, lasting, number, word
from momantu_bt.faults.rows_robot import (
    DRIVING,
    GRASPED_NOTHING,
    LOST_ITSELF,
    NO_WAY,
    SEEN_NOTHING,
)

SEEING = ("detect_object", "find_apriltag", "detect_plane")
BEFORE_GRASP = ("after-Grasp/detect_object", "after-detect_object", "pick")
CARRYING = ("Put/navigate+2 s", "after-pick+3 s", "place")
MISSED = SEEN_NOTHING | GRASPED_NOTHING | {"STALE_POSE", "NO_GRASP", "NO_PLAN"}


def _kind(name: str, doc: str, *parameters: Any, **more: Any) -> FaultKind:
    component, _, mode = name.partition(".")
    where = more.pop("place", Where.WORLD)
    return FaultKind(component, mode, doc, where, parameters=parameters, **more)


WORLD = (
    _kind(
        "camera.misses_object",
        "The goal's item cannot be seen.",
        count("frames", 3, "for how many pictures", least=1),
        phases=SEEING,
        notice=20.0,
        recoverable=True,
        reasons=SEEN_NOTHING,
    ),
    _kind(
        "camera.phantom",
        "An item like the goal's is seen on the same surface where none is.",
        count("frames", 3, "for how many pictures", least=1),
        phases=SEEING,
        notice=60.0,
        recoverable=True,
        reasons=MISSED,
    ),
    _kind(
        "robot.kidnapped",
        "The robot is put elsewhere on free floor.",
        number("distance", 1.0, "m", "how far", 0.0),
        number("turn", 1.0, "rad", "how much it is turned", 0.0, pi),
        phases=DRIVING,
        notice=20.0,
        recoverable=True,
        reasons=LOST_ITSELF | NO_WAY,
    ),
    _kind(
        "doorway.blocked",
        "Something stands in the doorway ahead.",
        lasting(20.0),
        phases=("Put/navigate+1 s", *DRIVING),
        notice=30.0,
        recoverable=True,
        reasons=NO_WAY,
        variants=(Variant("for=inf", recoverable=False),),
    ),
    _kind(
        "person.in_way",
        "Somebody stands 1 m in front of the robot.",
        lasting(10.0),
        phases=DRIVING,
        notice=5.0,
        recoverable=True,
        reasons=NO_WAY,
        variants=(Variant("for=inf", recoverable=False),),
    ),
    _kind(
        "object.moved",
        "The goal's item is moved on its surface.",
        number("distance", 0.08, "m", "how far", 0.0),
        phases=BEFORE_GRASP,
        notice=60.0,
        recoverable=True,
        reasons=MISSED,
    ),
    _kind(
        "object.knocked_over",
        "The goal's item is laid on its side.",
        phases=BEFORE_GRASP,
        notice=60.0,
        recoverable=False,
        reasons=MISSED,
    ),
    _kind(
        "object.removed",
        "The goal's item is taken away.",
        phases=BEFORE_GRASP,
        notice=60.0,
        recoverable=False,
        reasons=MISSED,
    ),
    _kind(
        "object.lost",
        "What is carried is taken out of the hand and laid on the floor.",
        phases=CARRYING,
        notice=5.0,
        recoverable=False,
        reasons=GRASPED_NOTHING | {"OBJECT_NOT_FOUND"},
    ),
    _kind(
        "place.occupied",
        "Boxes stand on the free spots beside the marker.",
        count("free", 1, "how many spots within the goal's distance are left"),
        phases=("Put", "find_apriltag", "detect_plane"),
        notice=90.0,
        recoverable=True,
        reasons=frozenset({"NO_FREE_SPOT", "NO_PLACE_POSE", "NO_PLAN", "TAG_NOT_SEEN"}),
        variants=(Variant("free=0", recoverable=False),),
    ),
    _kind(
        "tag.covered",
        "Something lies on the tag.",
        lasting(inf),
        phases=("find_apriltag",),
        notice=90.0,
        recoverable=False,
        reasons=frozenset({"TAG_NOT_SEEN"}),
        variants=(Variant("for=20 s", recoverable=True),),
    ),
    _kind(
        "tag.wrong_id",
        "The tag bears another number.",
        count("id", 7, "which one"),
        phases=(),
        notice=90.0,
        recoverable=False,
        reasons=frozenset({"TAG_NOT_SEEN"}),
    ),
)

SITE = (
    _kind(
        "map.wrong",
        "The floor plan lacks a piece of wall, or lies elsewhere than the places on it.",
        number("missing", 1.5, "m", "length of the stretch of wall that is not on it", 0.0),
        number("shift", 0.0, "m", "how far the plan lies off, in a direction of the seed's", 0.0),
        place=Where.SITE,
        phases=(),
        notice=60.0,
        recoverable=True,
        reasons=LOST_ITSELF | NO_WAY | SEEN_NOTHING,
        variants=(Variant("missing=0, shift=50 cm", recoverable=False),),
    ),
    _kind(
        "table.height",
        "Surfaces are told higher than they are.",
        number("by", 0.05, "m", "how much too high; below 0: too low", -1.0, 1.0),
        word("surface", "", "which one; else all"),
        place=Where.SITE,
        phases=(),
        notice=60.0,
        recoverable=True,
        reasons=SEEN_NOTHING | {"NO_CONTACT", "NO_PLAN", "NO_GRASP", "NO_PLACE_POSE"},
    ),
)

KINDS: tuple[FaultKind, ...] = (*WORLD, *SITE)

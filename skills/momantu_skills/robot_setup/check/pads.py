"""Checks of how the pads face what they hold: forces that lean push it along the fingers."""

from __future__ import annotations

import math
from collections.abc import Iterator

from momantu_bt.findings import FindingAtKeys
from momantu_bt.formats.problems import Severity
from momantu_skills.manipulation.hand.grasps import OPENING, beyond_axis
from momantu_skills.manipulation.hand.seating import Seat
from momantu_skills.manipulation.model.arm_model import ArmModel

USUAL = 0.07
"""Diameter of a can, m: pads that lean are judged by how they hold one, or what fits."""
SLIDES = math.radians(30)
"""Lean of the forces, rad, at which many things slide: friction is 0.58 then."""


def check_pads(model: ArmModel) -> Iterator[FindingAtKeys]:
    """Pads that touch a can with an edge, or from which it slides out."""
    hand = model.description.hand
    width = min(USUAL, hand.max_width - OPENING)
    farthest = beyond_axis(hand)
    if width <= 0.0 or not model.open_fingers:
        return
    seat = Seat(hand, width / 2, model.fingers_at)
    lean, place = seat.lean(0.0), seat.best(0.0, farthest)
    what = (
        f"at a width of {1000 * width:.0f} mm the pads lean from each other: beside the grasp "
        f"frame their forces are {math.degrees(lean):.0f} deg off the closing direction"
    )
    if place > 0.0:
        yield FindingAtKeys(
            Severity.WARNING,
            "pads-lean",
            f"{what}, so that round things are held {1000 * place:.0f} mm farther out, by an edge "
            "alone, and may turn about it",
            "pads that stay parallel, or soft ones, hold firmly; let the description's pads be so "
            "where the real ones are",
            ("end_effector", "frame"),
        )
    elif lean > SLIDES:
        yield FindingAtKeys(
            Severity.WARNING,
            "pads-lean",
            f"{what} and nowhere along the pads much less, so that round things slide out",
            "pads that stay parallel hold them; let the description's pads be so where the real "
            "ones are",
            ("end_effector", "frame"),
        )

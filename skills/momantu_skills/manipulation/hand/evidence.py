"""What fingers, weight and picture say about whether the hand holds something, weighed.

Each says by how much likelier its reading is with something in the hand than with nothing, as the
natural logarithm of that ratio. The senses fail for different causes, so their logarithms add up.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from momantu_skills.manipulation.config import SceneConfig
from momantu_skills.manipulation.hand.between_pads import View
from momantu_skills.manipulation.scene.holding import RECENT, Fingers
from momantu_skills.manipulation.scene.payload import OPEN, Weight

SURE = math.log(100.0)
"""Sum from which the answer is given: a hundred to one."""
CLEAR = 4.0
"""What a sense must say to be in no doubt: 55 to 1."""
FINGERS = 5.0
"""What clear fingers say, 150 to 1: fingers that press are seldom jammed, and fingers that do not
seldom carry something that hangs on them."""
NOISE = 1.0 / math.sqrt(RECENT)
"""Standard deviation of the mean closing force, N."""
LIGHTEST, HEAVIEST = 0.3, 20.0
"""Range of the weights that are expected in a hand, N, each factor of two as likely."""
WEIGHT = 6.0
"""The most that a weight says: a hand may also carry what hangs on it, or lean on something."""
PICTURE = 4.0
"""What a clear picture says, 55 to 1: hand and camera are where they are believed to be within 1 cm
but for a fault."""
SOME = 25
"""Points between the pads that prove something: 1 cm2 at 0.6 m."""
THROUGH = 0.5
"""Share of the space between the pads that a picture shows to be empty if it is."""


class Grip(StrEnum):
    """What is believed of the hand."""

    HELD = "it holds something"
    EMPTY = "it holds nothing"
    UNKNOWN = "cannot tell"


@dataclass(frozen=True, slots=True)
class Evidence:
    """What one sense says. odds: the logarithm, positive for something held. text: in words."""

    sense: str
    odds: float
    text: str


def clear(evidence: Sequence[Evidence]) -> bool:
    """Whether every sense says the same, and none of them is in doubt."""
    return min(each.odds for each in evidence) >= CLEAR or max(e.odds for e in evidence) <= -CLEAR


def weighed(evidence: Sequence[Evidence]) -> Grip:
    """What all evidence together says."""
    total = sum(each.odds for each in evidence)
    if abs(total) < SURE:
        return Grip.UNKNOWN
    return Grip.HELD if total > 0.0 else Grip.EMPTY


def of_fingers(fingers: Fingers, widest: float, config: SceneConfig) -> Evidence:
    """Fingers that press on something are stopped by it; shut ones hold nothing.

    widest: of the hand, m. Fingers that are open so far and press on nothing hold nothing, whatever
    the weight.
    """
    text = (
        f"the fingers are {fingers.width * 1000:.0f} mm open and press with {fingers.effort:.0f} N"
    )
    if math.isnan(fingers.width):
        return Evidence("fingers", 0.0, "the fingers have not been read")
    if fingers.width < config.closed_width:
        return Evidence("fingers", -FINGERS, text)
    if fingers.width > OPEN * widest and fingers.effort < config.least_effort:
        return Evidence("fingers", -(WEIGHT + FINGERS), text)
    off = (fingers.effort - config.least_effort) / NOISE
    return Evidence("fingers", float(np.clip(off * FINGERS / 2, -FINGERS, FINGERS)), text)


def of_weight(measured: Weight) -> Evidence:
    """A weight in the hand.

    A hand that is pushed up leans on something, and its weight says nothing.
    """
    weight, sigma = measured.value, measured.sigma
    text = f"the hand carries {weight:.1f} N"
    if weight < -4.0 * sigma:
        return Evidence("weight", 0.0, f"something pushes the hand up by {-weight:.1f} N")
    weight = min(weight, 8.0 * sigma)  # beyond, nothing changes
    held = np.geomspace(LIGHTEST, HEAVIEST, 200)
    with_it = float(np.mean(np.exp(-0.5 * ((weight - held) / sigma) ** 2)))
    without = math.exp(-0.5 * (weight / sigma) ** 2)
    odds = math.log(max(with_it, 1e-12)) - math.log(max(without, 1e-12))
    return Evidence("weight", float(np.clip(odds, -WEIGHT, WEIGHT)), text)


def of_picture(view: View) -> Evidence:
    """What a depth picture shows between the pads, or through between them."""
    if view.points >= SOME:
        return Evidence("picture", PICTURE, f"{view.points} points are seen between the pads")
    if view.through >= THROUGH:
        text = f"{view.through:.0%} of the space between the pads is seen to be empty"
        return Evidence("picture", -PICTURE, text)
    return Evidence("picture", 0.0, "the picture does not show the space between the pads")

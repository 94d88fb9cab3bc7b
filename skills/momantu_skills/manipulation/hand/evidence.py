"""What fingers, weight and picture say about whether the hand holds something, weighed.

Each says by how much likelier its reading is with something in the hand than with nothing, as the
natural logarithm of that ratio. The senses fail for different causes, so their logarithms add up.
The probabilities are fitted to states of the hand that `benchmarks/hand_states.py` makes, each kind
as often as the others: the share of k in n states for one of m readings is (k + 1/2) / (n + m/2),
after Krichevsky and Trofimov (1981), "The performance of universal encoding".
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy.special import ndtr

from momantu_skills.manipulation.config import SceneConfig
from momantu_skills.manipulation.hand.between_pads import View
from momantu_skills.manipulation.scene.holding import RECENT, Fingers
from momantu_skills.manipulation.scene.payload import OPEN, Weight

SURE = math.log(100.0)
"""Sum from which the answer is given: a hundred to one."""
SHUT, OPENED, FREE, PRESSING = (0.001, 0.26), (0.001, 0.11), (0.001, 0.22), (0.996, 0.40)
"""How probable each reading of the fingers is with something in the hand, and with nothing."""
ALONE = (0.996, 0.005)
"""The same of fingers that press in a hand that nothing weighs: no other sense tells jammed ones,
which are rarer in use than among those states, so they count as one in two hundred."""
SEEN, THROUGH = (0.14, 0.016), (0.001, 0.12)
"""The same of a picture that shows something between the pads, and of one that shows through."""
LEANING = (0.19, 0.08)
"""Share of states in which something under the hand carries what it holds, or pushes at the hand if
it is empty."""
DRAWN = 0.15
"""Share of the empty hands that lean on something which draws them down too."""
DRAGGED, DRAG = 0.03, 1.5
"""Share of empty hands that friction drags straight down, by up to DRAG, N. It is a hundredth among
those states, and counts threefold: light things are then not believed before the hand is raised."""
SWAY = 1.0
"""Standard deviation of the load aside, per axis, of what hangs in the hand while the arm is at
rest, N: 1.5 N at the most among ten things held; hands that lean show 2 to 100 N."""
HANGING = 0.004
"""Share of states in which something hangs on an empty hand."""
NOISE = 1.0 / math.sqrt(RECENT)
"""Standard deviation of the mean closing force, N."""
LIGHTEST, HEAVIEST = 0.3, 20.0
"""Range of the weights that are expected in a hand, N, each factor of two as likely."""
RAISED = 0.02
"""What is left of LEANING and DRAGGED in a hand that was raised since its fingers moved."""
SOME = 25
"""Points between the pads that prove something: 1 cm2 at 0.6 m."""
EMPTY_FROM = 0.5
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


def weighed(evidence: Sequence[Evidence]) -> Grip:
    """What all evidence together says."""
    total = sum(each.odds for each in evidence)
    if abs(total) < SURE:
        return Grip.UNKNOWN
    return Grip.HELD if total > 0.0 else Grip.EMPTY


def agree(evidence: Sequence[Evidence]) -> bool:
    """Whether no sense speaks against another one."""
    return min(each.odds for each in evidence) >= 0.0 or max(e.odds for e in evidence) <= 0.0


def of_fingers(
    fingers: Fingers, widest: float, config: SceneConfig, *, alone: bool = False
) -> Evidence:
    """Fingers that press are stopped by something, or jammed; shut ones hold little.

    widest: of the hand, m. Whether they press is as sure as their force is above or below the
    least one. alone: the robot has nothing that weighs the hand.
    """
    if math.isnan(fingers.width):
        return Evidence("fingers", 0.0, "the fingers have not been read")
    text = (
        f"the fingers are {fingers.width * 1000:.0f} mm open and press with {fingers.effort:.0f} N"
    )
    if fingers.width < config.closed_width:
        return Evidence("fingers", _odds(*SHUT), text)
    press = 0.5 * math.erfc((config.least_effort - fingers.effort) / NOISE / math.sqrt(2.0))
    idle = OPENED if fingers.width > OPEN * widest else FREE
    pairs = zip(ALONE if alone else PRESSING, idle, strict=True)
    return Evidence("fingers", _odds(*(press * p + (1.0 - press) * f for p, f in pairs)), text)


def of_weight(measured: Weight, *, raised: bool) -> Evidence:
    """A weight in the hand.

    What the hand holds shows its weight, unless something carries it: in part, or wholly. An empty
    hand shows none, unless it leans on something or something hangs on it. What hangs pulls
    straight down; what the hand leans on may push it aside too, or drag it down. raised: since
    the fingers moved, so that nothing that was under the hand carries it.
    """
    weight, sigma = measured.value, measured.sigma
    aside = math.hypot(*measured.aside)
    pulled = f", and is pushed aside with {aside:.0f} N" if aside > 4.0 * SWAY else ""
    text = f"the hand carries {weight:.1f} N{pulled}"
    straight, leaning = _aside(aside, sigma)
    weight = min(max(weight, -HEAVIEST), HEAVIEST)
    nothing = math.exp(-0.5 * (weight / sigma) ** 2) / (sigma * math.sqrt(2.0 * math.pi))
    below = np.diff(ndtr((weight - EDGES) / sigma)) * -1.0  # probability of each interval
    full, in_part, hung, dragged = (float(below @ each) for each in (FULL, IN_PART, HUNG, RUBBED))
    pushed = float(ndtr(-weight / sigma)) / HEAVIEST
    held, empty = (share * (RAISED if raised else 1.0) for share in LEANING)
    shown = (nothing + in_part + pushed) / 3
    with_it = (1.0 - held) * full * straight + held * shown * leaning
    leant = (1.0 - DRAWN) * pushed + DRAWN * in_part
    rubbed = DRAGGED * (RAISED if raised else 1.0)
    free = (1.0 - empty - rubbed - HANGING) * nothing + HANGING * hung + rubbed * dragged
    without = free * straight + empty * leant * leaning
    return Evidence("weight", _odds(with_it, without), text)


def _aside(aside: float, sigma: float) -> tuple[float, float]:
    """Density of a load aside, N, of what hangs, and of a hand that leans on something, 1/N2.

    It is normal, or as often anything up to HEAVIEST. Where it is not known, both are 1.
    """
    if math.isnan(aside):
        return 1.0, 1.0
    variance = SWAY**2 + sigma**2
    straight = math.exp(-0.5 * aside**2 / variance) / (2.0 * math.pi * variance)
    return straight, 0.5 * straight + 0.5 / (math.pi * HEAVIEST**2)


EDGES = np.concatenate([[0.0], np.geomspace(LIGHTEST, HEAVIEST, 60)])
"""Ends of intervals of weights, N."""
_MIDDLES = (EDGES[1:] + EDGES[:-1]) / 2
_SPAN = math.log(HEAVIEST / LIGHTEST)
FULL = np.where(_MIDDLES > LIGHTEST, 1.0 / (_MIDDLES * _SPAN), 0.0)
"""Density of the weight of what is held, by interval, 1/N: its logarithm is uniform."""
IN_PART = (1.0 / np.maximum(_MIDDLES, LIGHTEST) - 1.0 / HEAVIEST) / _SPAN
"""The same if something carries a part of it, a share that is uniform."""
HUNG = np.full(len(_MIDDLES), 1.0 / HEAVIEST)
"""The same of what hangs on an empty hand."""
RUBBED = np.where(_MIDDLES < DRAG, 1.0 / DRAG, 0.0)
"""The same of what friction drags an empty hand down with."""


def _odds(held: float, empty: float) -> float:
    return math.log(held) - math.log(empty)


def of_picture(view: View, *, raised: bool) -> Evidence:
    """What a depth picture shows between the pads, or through between them.

    raised: as for a weight. Before, what is seen may belong to what the hand leans on.
    """
    if view.points >= SOME:
        text = f"{view.points} points are seen between the pads"
        return Evidence("picture", _odds(*SEEN) if raised else 0.0, text)
    if view.through >= EMPTY_FROM:
        text = f"{view.through:.0%} of the space between the pads is seen to be empty"
        return Evidence("picture", _odds(*THROUGH), text)
    return Evidence("picture", 0.0, "the picture does not show the space between the pads")

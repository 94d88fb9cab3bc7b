"""What each sense says of the hand, and what all say together."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.manipulation.config import SceneConfig
from momantu_skills.manipulation.hand.between_pads import View
from momantu_skills.manipulation.hand.evidence import (
    DRAG,
    SURE,
    Evidence,
    Grip,
    of_fingers,
    of_picture,
    of_weight,
    weighed,
)
from momantu_skills.manipulation.scene.holding import Fingers
from momantu_skills.manipulation.scene.payload import Weight

CONFIG = SceneConfig()
PRESSING, FREE, OPENED = Fingers(0.07, 45.0), Fingers(0.04, 0.1), Fingers(0.1, 0.1)
NOTHING_SEEN = View(0, 0.0)


@pytest.mark.parametrize(
    ("fingers", "weight", "grip"),
    [
        (PRESSING, None, Grip.UNKNOWN),  # fingers may be jammed
        (FREE, None, Grip.EMPTY),
        (PRESSING, Weight(3.9, 0.25, 0.1), Grip.HELD),
        (PRESSING, Weight(3.9, 0.25, 0.6), Grip.HELD),
        (FREE, Weight(0.1, 0.25, 0.1), Grip.EMPTY),
        (PRESSING, Weight(0.6, 0.08, 0.06), Grip.UNKNOWN),  # friction may drag the hand down
        (PRESSING, Weight(0.0, 0.25, 0.1), Grip.UNKNOWN),  # jammed, or what is held stands
        (FREE, Weight(3.9, 0.25, 0.1), Grip.UNKNOWN),
        (Fingers(0.07, 3.0), None, Grip.UNKNOWN),
        (Fingers(0.001, 45.0), None, Grip.EMPTY),
        (Fingers(math.nan, math.nan), None, Grip.UNKNOWN),
    ],
)
def test_fingers_and_weight_together(fingers, weight, grip) -> None:
    evidence = [of_fingers(fingers, 0.1, CONFIG)]
    evidence += [] if weight is None else [of_weight(weight, raised=False)]
    assert weighed(evidence) is grip


def test_fingers_that_press_on_nothing_that_weighs_are_jammed_once_they_were_raised() -> None:
    """Before, what they press on may stand on something."""
    weight = Weight(0.0, 0.08, 0.07)
    pressing = of_fingers(PRESSING, 0.1, CONFIG)
    assert weighed([pressing, of_weight(weight, raised=False)]) is Grip.UNKNOWN
    assert weighed([pressing, of_weight(weight, raised=True)]) is Grip.EMPTY


def test_a_robot_that_cannot_weigh_believes_fingers_that_press_unless_it_sees_through() -> None:
    alone = of_fingers(PRESSING, 0.1, CONFIG, alone=True)
    assert weighed([alone]) is Grip.HELD
    assert weighed([alone, of_picture(NOTHING_SEEN, raised=True)]) is Grip.HELD
    assert weighed([alone, of_picture(View(0, 0.9), raised=True)]) is Grip.UNKNOWN


@pytest.mark.parametrize(
    ("view", "grip"),
    [(View(0, 0.9), Grip.EMPTY), (NOTHING_SEEN, Grip.UNKNOWN), (View(80, 0.0), Grip.UNKNOWN)],
)
def test_a_picture_may_decide_what_fingers_and_weight_do_not(view: View, grip: Grip) -> None:
    """Fingers that press while nothing weighs: jammed, or around something that stands."""
    evidence = [
        of_fingers(PRESSING, 0.1, CONFIG),
        of_weight(Weight(0.0, 0.25, 0.1), raised=False),
        of_picture(view, raised=False),
    ]
    assert weighed(evidence) is grip


def test_what_is_seen_of_a_hand_that_was_not_raised_may_be_what_it_leans_on() -> None:
    assert of_picture(View(200, 0.0), raised=False).odds == 0.0
    assert of_picture(View(200, 0.0), raised=True).odds > 1.0
    assert of_picture(View(0, 0.9), raised=False).odds < -3.0


def test_nothing_known_is_no_answer() -> None:
    assert weighed([]) is Grip.UNKNOWN


@given(st.lists(st.floats(-6, 6), max_size=5))
def test_an_answer_takes_a_hundred_to_one(odds: list[float]) -> None:
    grip = weighed([Evidence("any", each, "") for each in odds])
    total = sum(odds)
    assert (grip is Grip.HELD) is (total >= SURE)
    assert (grip is Grip.EMPTY) is (total <= -SURE)


@given(st.floats(0.5, 15.0), st.floats(0.05, 0.4))
def test_a_weight_speaks_for_something_and_none_against_it(weight: float, sigma: float) -> None:
    some, none = (of_weight(Weight(w, sigma, 0.0), raised=False) for w in (4 * sigma + weight, 0.0))
    assert some.odds > 0.0 > none.odds


@given(st.floats(-20.0, 20.0), st.floats(0.05, 1.0), st.booleans())
def test_no_weight_alone_decides(weight: float, sigma: float, raised: bool) -> None:
    """Something may hang on the hand."""
    odds = of_weight(Weight(weight, sigma, 0.0), raised=raised).odds
    assert math.isfinite(odds)
    assert odds < 8.0


def test_a_hand_that_is_pushed_up_says_little() -> None:
    assert abs(of_weight(Weight(-8.0, 0.25, 0.1), raised=False).odds) < SURE


@given(
    st.floats(0.3, 15.0),
    st.floats(8.0, 100.0),
    st.floats(0.05, 0.4),
    st.booleans(),
    st.floats(0, 6),
)
def test_a_hand_that_is_pushed_aside_leans_and_its_weight_is_no_proof(
    weight: float, push: float, sigma: float, raised: bool, way: float
) -> None:
    """What hangs in a hand pulls straight down; jammed fingers that lean may show some weight."""
    aside = (push * math.cos(way), push * math.sin(way))
    found = of_weight(Weight(weight, 0.08, sigma, aside), raised=raised)
    pressing = of_fingers(Fingers(0.06, 45.0), 0.1, CONFIG)
    assert weighed([pressing, found]) is Grip.UNKNOWN
    assert "pushed aside" in found.text


@given(st.floats(0.6, 15.0), st.floats(0.0, 2.0), st.booleans())
def test_what_pulls_straight_down_is_held(weight: float, aside: float, raised: bool) -> None:
    """It may swing a little. Friction may drag an empty hand down as light things do."""
    found = of_weight(Weight(weight, 0.08, 0.07, (aside, 0.0)), raised=raised)
    grip = weighed([of_fingers(Fingers(0.06, 45.0), 0.1, CONFIG), found])
    if raised or weight > DRAG + 0.5:
        assert grip is Grip.HELD
    elif weight < DRAG - 0.5:
        assert grip is Grip.UNKNOWN


def test_a_weight_is_as_sure_as_its_sensor() -> None:
    vague, sure = (of_weight(Weight(0.0, 0.25, s), raised=True).odds for s in (0.6, 0.1))
    assert abs(vague) < abs(sure)


@pytest.mark.parametrize("effort", np.linspace(-3.0, 50.0, 12))
def test_the_harder_the_fingers_press_the_likelier_it_holds_something(effort: float) -> None:
    harder = of_fingers(Fingers(0.05, effort + 1.0), 0.1, CONFIG).odds
    assert harder >= of_fingers(Fingers(0.05, effort), 0.1, CONFIG).odds

"""Matching: near sizes score high, other things score low, and what is untold is no objection."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.perception.objects.matching import MatchConfig, misfits, score
from momantu_skills.perception.objects.shapes import Shape

from momantu_bt.geometry import Pose, Transform
from momantu_bt.messages import DetectedObject, ObjectClass

CAN = ObjectClass("can", diameter=0.07, height=0.13)
ACCEPTED = MatchConfig().accepted


def measured(x: float, y: float, z: float, category: str = "can", kind: str = "cylinder") -> Shape:
    return Shape(kind, category, (0.0, 0.0), 0.0, (x, y, z), 0.001, 0.001, 0.0)


def can(diameter: float, height: float) -> Shape:
    return measured(diameter, diameter, height)


def test_exactly_what_is_asked_scores_one() -> None:
    assert score(can(0.07, 0.13), CAN) == 1.0


@given(st.floats(-0.0045, 0.0045), st.floats(-0.006, 0.006))
def test_measuring_errors_are_accepted(wider: float, taller: float) -> None:
    assert ACCEPTED <= score(can(0.07 + wider, 0.13 + taller), CAN) <= 1.0


@given(st.floats(0.2, 1.0), st.sampled_from([-1, 1]), st.booleans(), st.floats(-0.004, 0.004))
def test_similar_things_differ_by_a_fifth_and_score_nothing(
    share: float, sign: int, in_height: bool, error: float
) -> None:
    diameter, height = (
        (0.07, 0.13 * (1 + sign * share))
        if in_height
        else (
            0.07 * (1 + sign * share),
            0.13,
        )
    )
    assert score(can(diameter + error, height + error), CAN) < ACCEPTED


@given(st.floats(0.0, 0.006), st.floats(0.0, 0.006))
def test_nearer_scores_higher(first: float, second: float) -> None:
    near, far = sorted((first, second))
    assert score(can(0.07 + near, 0.13), CAN) >= score(can(0.07 + far, 0.13), CAN)


def test_another_form_needs_nearly_exact_sizes() -> None:
    assert score(measured(0.07, 0.07, 0.13, "mug"), CAN) >= ACCEPTED
    assert score(measured(0.074, 0.074, 0.137, "mug"), CAN) < ACCEPTED
    assert score(measured(0.07, 0.05, 0.13, "box", "box"), CAN) == 0.0


def test_without_sizes_the_form_decides() -> None:
    asked = ObjectClass("bottle")
    assert score(measured(0.06, 0.06, 0.2, "bottle"), asked) >= ACCEPTED
    assert score(measured(0.06, 0.06, 0.2, "can"), asked) < ACCEPTED


def test_a_category_without_a_form_is_found_by_size() -> None:
    asked = ObjectClass("milk carton", width=0.07, depth=0.07, height=0.2)
    assert score(measured(0.07, 0.07, 0.2, "box", "box"), asked) == 1.0


@pytest.mark.parametrize("turned", [False, True])
def test_width_and_depth_are_in_no_order(turned: bool) -> None:
    asked = ObjectClass("box", width=0.06, depth=0.1, height=0.12)
    size = (0.1, 0.06, 0.12) if turned else (0.06, 0.1, 0.12)
    assert score(measured(*size, "box", "box"), asked) == 1.0
    alone = ObjectClass("box", width=0.1)
    assert score(measured(*size, "box", "box"), alone) == 1.0


def seen(category: str, x: float, y: float, z: float, shape: str = "cylinder") -> DetectedObject:
    pose = Pose(Transform((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)), "odom", 0.0)
    return DetectedObject(category, pose, (x, y, z), shape, 0.3, 0.7)


@pytest.mark.parametrize(
    ("thing", "asked", "why"),
    [
        (
            seen("bottle", 0.063, 0.063, 0.2),
            ObjectClass("bottle", diameter=0.054),
            ["9 mm too wide (asked 54 ± 6 mm)"],
        ),
        (
            seen("can", 0.05, 0.05, 0.16),
            CAN,
            ["30 mm too high (asked 130 ± 13 mm)", "20 mm too narrow (asked 70 ± 7 mm)"],
        ),
        (seen("mug", 0.07, 0.07, 0.13), ObjectClass("can"), ["no can by its shape"]),
        (seen("can", 0.076, 0.076, 0.142), CAN, ["all sizes differ a little: it matches by 30 %"]),
        (
            seen("box", 0.06, 0.09, 0.2, "box"),
            ObjectClass("carton", width=0.09, depth=0.07, height=0.1),
            ["100 mm too high (asked 100 ± 10 mm)", "10 mm too narrow (asked 70 ± 7 mm)"],
        ),
    ],
)
def test_what_does_not_fit_is_told_with_how_much(
    thing: DetectedObject, asked: ObjectClass, why: list[str]
) -> None:
    assert misfits(thing, asked) == why


@given(st.floats(0.01, 0.2), st.floats(0.02, 0.4))
def test_a_size_is_told_exactly_if_it_alone_refuses_the_object(
    diameter: float, high: float
) -> None:
    told = misfits(seen("can", diameter, diameter, high), CAN)
    refused = score(can(diameter, high), CAN) == 0.0
    assert refused == any("asked" in words for words in told)

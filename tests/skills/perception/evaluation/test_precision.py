"""Average precision: by hand in small cases."""

from __future__ import annotations

import pytest
from momantu_skills.perception.evaluation.boxes import Solid
from momantu_skills.perception.evaluation.precision import (
    MEASURES,
    Picture,
    average_precisions,
)

from momantu_bt.geometry import Transform

SIZE = (0.07, 0.07, 0.12)


def can(x: float, category: str = "can") -> Solid:
    return Solid(category, Transform((x, 0.0, 1.0)), SIZE, turns=True)


def ap(*pictures: Picture) -> float:
    return average_precisions(pictures, ("can", "mug"))["can"]["iou50"]


def test_all_found_and_nothing_else_is_one() -> None:
    picture = Picture((can(0.0), can(0.3)), ((can(0.3), 0.6), (can(0.0), 0.9)))
    found = average_precisions([picture], ("can", "mug"))
    assert set(found) == {"mean", "can"}
    assert found["can"] == dict.fromkeys(MEASURES, 1.0) == found["mean"]


def test_half_found_is_half() -> None:
    assert ap(Picture((can(0.0), can(0.3)), ((can(0.0), 0.9),))) == pytest.approx(0.5)


def test_nothing_found_is_zero() -> None:
    assert ap(Picture((can(0.0),), ())) == 0.0


def test_a_wrong_one_costs_only_if_it_is_surer() -> None:
    wrong, right = can(1.0), can(0.0)
    assert ap(Picture((right,), ((right, 0.9), (wrong, 0.1)))) == pytest.approx(1.0)
    assert ap(Picture((right,), ((right, 0.1), (wrong, 0.9)))) == pytest.approx(0.5)


def test_a_thing_is_found_once() -> None:
    twice = Picture((can(0.0), can(0.3)), ((can(0.0), 0.9), (can(0.0), 0.8)))
    assert ap(twice) == pytest.approx(0.5)


def test_the_category_must_be_right() -> None:
    assert ap(Picture((can(0.0),), ((can(0.0, "mug"), 0.9),))) == 0.0

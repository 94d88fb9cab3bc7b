"""How likely a found thing is right: more with more cells, agreement and certainty."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from momantu_skills.perception.learned.confidence import chance
from momantu_skills.perception.learned.solids import Solid

from momantu_bt.geometry import Transform, quaternion_from_axis_angle

CAN = Solid("can", Transform((0, 0, 0.06)), (0.07, 0.07, 0.12), 400, 0.9, False, 0.8)
LYING = Transform((0, 0, 0.06), quaternion_from_axis_angle((1, 0, 0), math.pi / 2))


@pytest.mark.parametrize(
    "worse",
    [
        replace(CAN, cells=60),
        replace(CAN, sure=0.5),
        replace(CAN, agreeing=0.3),
        replace(CAN, frame_from_object=LYING),
    ],
    ids=["cells", "sure", "agreeing", "lying"],
)
def test_less_evidence_is_a_smaller_chance(worse: Solid) -> None:
    assert 0.0 < chance(worse) < chance(CAN) < 1.0


def test_a_well_seen_thing_is_likely_and_a_ghost_is_not() -> None:
    assert chance(CAN) > 0.9
    assert chance(replace(CAN, cells=15, sure=0.4, agreeing=0.2)) < 0.1


def test_a_box_has_no_axis_that_could_lie() -> None:
    box = replace(CAN, category="box")
    assert chance(box) == chance(replace(box, frame_from_object=LYING))

"""Two detectors that check each other: what both see, what one sees, what they differ about."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest
from momantu_skills.perception.learned.both import ALONE, BothDetectors

from momantu_bt.detector import DETECTORS, View
from momantu_bt.geometry import Pose, Transform, quaternion_from_axis_angle
from momantu_bt.messages import DetectedObject, ObjectClass

CAN = DetectedObject(
    "can", Pose(Transform((1.0, 0.0, 0.76)), "odom", 2.0), (0.07, 0.07, 0.12), "cylinder", 0.9, 0.7
)


@dataclass
class Says:
    """A detector that always says the same."""

    answer: Sequence[DetectedObject] | None
    accepted: float = 0.5
    budget: float = 0.1

    def detect(
        self, views: Sequence[View], low: float, high: float, asked: ObjectClass
    ) -> tuple[DetectedObject, ...] | None:
        return None if self.answer is None else tuple(self.answer)


def both(
    measured: Sequence[DetectedObject] | None, learned: Sequence[DetectedObject] | None
) -> tuple[DetectedObject, ...] | None:
    return BothDetectors(Says(measured), Says(learned)).detect((), 0.6, 0.8, ObjectClass("can"))


def moved(thing: DetectedObject, x: float, **changes: object) -> DetectedObject:
    position = thing.pose.position + np.array([x, 0.0, 0.0])
    pose = replace(thing.pose, transform=Transform(position, thing.pose.transform.quaternion))
    return replace(thing, pose=pose, **changes)


def test_what_both_see_is_measured_and_keeps_the_better_score() -> None:
    learned = moved(CAN, 0.012, size=(0.075, 0.075, 0.115), score=0.6)
    assert both([CAN], [learned]) == (CAN,)
    assert both([replace(CAN, score=0.6)], [replace(learned, score=0.9)]) == (CAN,)


def test_a_mug_is_turned_as_the_learned_one_says() -> None:
    turn = quaternion_from_axis_angle((0.0, 0.0, 1.0), 1.0)
    mug = replace(CAN, category="mug")
    handle = replace(mug, pose=Pose(Transform(CAN.pose.position, turn), "odom", 2.0), score=0.5)
    found = both([mug], [handle])
    assert found is not None
    assert found[0].pose.transform.yaw == pytest.approx(1.0)
    assert found[0].score == mug.score


@pytest.mark.parametrize(
    "learned",
    [
        replace(CAN, category="bottle", score=0.0),
        replace(CAN, size=(0.07, 0.07, 0.2), score=0.0),
        replace(
            CAN,
            pose=Pose(
                Transform(
                    CAN.pose.position, quaternion_from_axis_angle((1.0, 0.0, 0.0), math.pi / 2)
                ),
                "odom",
                2.0,
            ),
            score=0.0,
        ),
    ],
    ids=["category", "size", "lying"],
)
def test_what_they_differ_about_gets_the_mean_score(learned: DetectedObject) -> None:
    found = both([CAN], [learned])
    assert found == (replace(learned, score=0.45),)
    assert found[0].score < BothDetectors().accepted


def test_what_one_sees_alone_counts_less() -> None:
    assert both([CAN], []) == (replace(CAN, score=0.9 * ALONE),)
    assert both([], [CAN]) == (replace(CAN, score=0.9 * ALONE),)
    assert both(None, [CAN]) == (replace(CAN, score=0.9 * ALONE),)


def test_a_heap_gives_way_to_the_objects_in_it() -> None:
    heap = replace(moved(CAN, 0.04), category="box", size=(0.15, 0.07, 0.12), score=0.2)
    near, far = moved(CAN, 0.0, score=0.8), moved(CAN, 0.08, score=0.7)
    found = both([heap], [near, far])
    assert found is not None
    assert [thing.category for thing in found] == ["can", "can"]


def test_nothing_seen_and_no_surface_seen_are_told_apart() -> None:
    assert both(None, None) is None
    assert both([], None) == ()


def test_it_is_a_plug_in_that_takes_the_time_of_both() -> None:
    made = DETECTORS.load("both")()
    assert isinstance(made, BothDetectors)
    parts = [DETECTORS.load(name)().budget for name in ("geometric", "learned")]
    assert made.budget == pytest.approx(sum(parts))

"""Things of which a part is hidden, as what is asked for, where the depth allows that.

The scenes are points of surfaces of which each ray of the camera sees the nearest one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple, cast

import numpy as np
import pytest
from momantu_skills.perception.learned.bodies import Body, asked_body
from momantu_skills.perception.learned.completing import completed
from momantu_skills.perception.learned.detector import LearnedDetector
from momantu_skills.perception.learned.fusing import Look
from momantu_skills.perception.learned.solids import Solid

from momantu_bt.categories import USUAL, Symmetry
from momantu_bt.detector import View
from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import DetectedObject, ObjectClass
from momantu_bt.world import seeded

EYE = np.array([0.0, -0.7, 0.6])
"""The camera, m; the surface is at z = 0."""
RAY = 0.003
"""Angle between neighbouring rays, rad."""
LONG = ObjectClass("box", width=0.06, depth=0.20, height=0.08)
CAN = ObjectClass("can", diameter=0.07, height=0.12)


class Thing(NamedTuple):
    """A box or an upright cylinder on the surface."""

    size: tuple[float, float, float]
    at: tuple[float, float]
    yaw: float = 0.0
    round: bool = False

    @property
    def pose(self) -> Transform:
        return Transform.from_rpy((*self.at, self.size[2] / 2), (0.0, 0.0, self.yaw))

    def surface(self) -> Array:
        """Points (n, 3) on its sides and its top."""
        draw = seeded("thing", *self.size, *self.at)
        half, count = np.array(self.size) / 2, 250_000
        own = draw.uniform(-1.0, 1.0, (count, 3)) * half
        top = draw.uniform(size=count) < 0.4
        if self.round:
            bearing = draw.uniform(-math.pi, math.pi, count)
            away = half[0] * np.where(top, np.sqrt(draw.uniform(size=count)), 1.0)
            own[:, 0], own[:, 1] = away * np.cos(bearing), away * np.sin(bearing)
        else:
            across = draw.uniform(size=count) < half[1] / (half[0] + half[1])
            sign = draw.choice([-1.0, 1.0], count)
            own[:, 0] = np.where(across & ~top, sign * half[0], own[:, 0])
            own[:, 1] = np.where(~across & ~top, sign * half[1], own[:, 1])
        own[top, 2] = half[2]
        return self.pose.apply(own)


def seen(*things: Thing) -> list[Array]:
    """Points (n, 3) that the camera sees of the surface and of each thing, in this order."""
    draw = seeded("surface")
    table = np.column_stack([draw.uniform(-0.4, 0.4, (120_000, 2)), np.zeros(120_000)])
    groups = [table, *(thing.surface() for thing in things)]
    points, of = np.concatenate(groups), np.repeat(range(len(groups)), [len(g) for g in groups])
    way = points - EYE
    bearing = np.arctan2(way[:, 0], way[:, 1])
    slope = np.arctan2(way[:, 2], np.hypot(way[:, 0], way[:, 1]))
    ray = np.column_stack([bearing, slope]) // RAY
    order = np.lexsort((np.linalg.norm(way, axis=1), ray[:, 1], ray[:, 0]))
    ray, points, of = ray[order], points[order], of[order]
    first = np.ones(len(ray), dtype=bool)
    first[1:] = (ray[1:] != ray[:-1]).any(axis=1)
    points, of = points[first], of[first]
    return [points[of == number] for number in range(len(groups))]


def shown_as(category: str, chances: Mapping[str, float], *things: Thing) -> tuple[Solid, Look]:
    """The first thing as a network that tells what is seen of it has it, and the picture."""
    shown = seen(*things)
    own = shown[1]
    extent = (own - things[0].pose.position) @ things[0].pose.rotation
    low, high = extent.min(axis=0), extent.max(axis=0)
    size = tuple((high - low).tolist())
    if things[0].round:
        size = things[0].size
    middle = things[0].pose.apply((low + high) / 2)
    solid = Solid(
        category,
        Transform(middle, things[0].pose.quaternion),
        size,
        len(own),
        0.9,
        handle=False,
        chances=chances,
        points=own,
    )
    return solid, Look(0.0, 0.6, 0.0, (solid,), EYE, np.concatenate(shown))


def found(
    asked: ObjectClass, *things: Thing, chance: float = 0.9, told: str = ""
) -> tuple[Solid, float] | None:
    """The first thing completed to what is asked for."""
    category = told or asked.category
    chances = {category: 1.0 - chance, asked.category: chance}
    solid, look = shown_as(category, chances, *things)
    return completed(solid, asked, USUAL[asked.category], [look], 0.0)


@pytest.mark.parametrize("yaw", [0.0, 0.3, -0.5])
@pytest.mark.parametrize("hidden", [-0.07, 0.07])
def test_a_box_goes_on_behind_what_hides_it(yaw: float, hidden: float) -> None:
    box = Thing((0.20, 0.06, 0.08), (0.02, 0.1), yaw)
    way = np.array([math.cos(yaw), math.sin(yaw)])
    before = Thing((0.12, 0.05, 0.22), tuple((box.at + hidden * way - (0.0, 0.12)).tolist()))
    result = found(LONG, box, before)
    assert result is not None
    whole, worth = result
    assert sorted(whole.size) == pytest.approx([0.06, 0.08, 0.20])
    assert np.linalg.norm(whole.frame_from_object.position - box.pose.position) < 0.012
    assert 0.5 < worth < 0.86


def test_a_shorter_box_that_is_seen_whole_is_not_the_asked_one() -> None:
    assert found(LONG, Thing((0.15, 0.06, 0.08), (0.02, 0.1))) is None


def test_a_shorter_box_is_not_the_asked_one_where_the_surface_is_seen_behind_its_end() -> None:
    box, before = Thing((0.13, 0.06, 0.08), (0.0, 0.1)), Thing((0.02, 0.02, 0.12), (0.06, 0.03))
    assert found(LONG, box, before) is None


def test_a_box_of_another_height_or_longer_is_not_the_asked_one() -> None:
    before = Thing((0.12, 0.05, 0.22), (0.09, -0.02))
    assert found(LONG, Thing((0.20, 0.06, 0.11), (0.02, 0.1)), before) is None
    assert found(LONG, Thing((0.34, 0.06, 0.08), (0.02, 0.1)), before) is None


def test_a_can_of_which_a_half_is_hidden_has_its_middle_where_its_side_says() -> None:
    can = Thing((0.07, 0.07, 0.12), (0.0, 0.05), round=True)
    result = found(CAN, can, Thing((0.10, 0.05, 0.20), (0.065, -0.05)))
    assert result is not None
    assert np.linalg.norm(result[0].frame_from_object.position - can.pose.position) < 0.012


def test_a_box_taken_for_a_can_is_the_asked_box_if_that_is_likely_enough() -> None:
    asked = ObjectClass("box", width=0.06, depth=0.07, height=0.12)
    box = Thing((0.06, 0.07, 0.12), (0.0, 0.05), 0.4)
    result = found(asked, box, chance=0.3, told="can")
    assert result is not None
    assert result[0].category == "box"
    assert not result[0].has_axis
    assert found(asked, box, chance=0.1, told="can") is None


def test_what_is_asked_for_without_all_sizes_has_no_body() -> None:
    assert asked_body(ObjectClass("can", height=0.1), Symmetry.ENDS) is None
    assert asked_body(ObjectClass("box", width=0.1, height=0.1), Symmetry.BOX) is None
    assert asked_body(ObjectClass("spray", diameter=0.1, height=0.1), Symmetry.NONE) is None
    assert asked_body(ObjectClass("bowl", diameter=0.15, height=0.06), Symmetry.ROUND) is None
    bottle = asked_body(ObjectClass("bottle", diameter=0.06, height=0.2), Symmetry.ROUND)
    assert bottle is not None
    assert bottle.slender


@pytest.mark.parametrize("is_round", [False, True])
def test_distances_from_a_body_are_those_to_the_nearest_point_of_its_surface(
    is_round: bool,
) -> None:
    thing = Thing((0.08, 0.08, 0.10), (0.0, 0.0), round=is_round)
    body = Body(np.array(thing.size) / 2, is_round, hollow=False, slender=False)
    surface = thing.pose.inverse().apply(thing.surface())
    surface = np.concatenate([surface, surface * (1.0, 1.0, -1.0)])
    points = seeded("distances").uniform(-0.1, 0.1, (50, 3))
    nearest = np.linalg.norm(points[:, None] - surface[None], axis=2).min(axis=1)
    inside = body.distances(points) < 0.0
    assert np.allclose(np.abs(body.distances(points)), nearest, atol=0.003)
    assert inside.any()
    assert not inside.all()


@pytest.mark.parametrize("is_round", [False, True])
def test_points_behind_a_body_are_those_whose_ray_goes_through_it(is_round: bool) -> None:
    body = Body(np.array([0.04, 0.04, 0.05]), is_round, hollow=False, slender=False)
    eye, points = np.array([0.3, -0.1, 0.2]), seeded("behind").uniform(-0.2, 0.2, (200, 3))
    steps = np.linspace(0.0, 1.0, 2000)[:, None, None]
    inside = body._replace(half=body.half - 0.008).distances(
        (eye + steps * (points - eye)).reshape(-1, 3)
    )
    crossed = (inside.reshape(2000, -1) < 0.0).any(axis=0)
    ends = body._replace(half=body.half - 0.008).distances(points) < 0.0
    assert ((body.behind(eye, points) > 0.0) == (crossed & ~ends)).mean() > 0.98


def detected(
    asked: ObjectClass, look: Look, monkeypatch: pytest.MonkeyPatch
) -> tuple[LearnedDetector, list[DetectedObject]]:
    """What the detector says of a picture in which its network sees the look's things."""
    detector = LearnedDetector()
    monkeypatch.setattr(detector, "_look", lambda *_: look)
    return detector, list(detector.detect([cast(View, None)], 0.0, 1.0, asked) or ())


def test_the_detector_is_not_sure_of_a_completed_thing(monkeypatch: pytest.MonkeyPatch) -> None:
    box = Thing((0.20, 0.06, 0.08), (0.02, 0.1))
    _, look = shown_as("box", {"box": 0.9}, box, Thing((0.12, 0.05, 0.22), (0.09, -0.02)))
    detector, (only,) = detected(LONG, look, monkeypatch)
    assert detector.accepted <= only.score < detector.sure
    assert sorted(only.size) == pytest.approx([0.06, 0.08, 0.20])
    whole = replace(look.solids[0], size=(0.20, 0.06, 0.08))
    both = replace(look, solids=(replace(whole, frame_from_object=Transform((0.3, 0.3, 0.04))),))
    detector, things = detected(
        LONG, replace(both, solids=(*both.solids, *look.solids)), monkeypatch
    )
    assert [thing.score >= detector.sure for thing in things] == [True, False]
    assert things[1].score < detector.accepted


@pytest.mark.parametrize("sizes", [{"diameter": 0.08, "height": 0.1}, {}])
def test_a_likely_category_counts_more_if_sizes_speak_for_it(
    sizes: dict[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    scores = []
    for likely in (0.4, 0.05):
        can = Thing((0.08, 0.08, 0.1), (0.0, 0.1), round=True)
        solid, look = shown_as("can", {"can": 0.5, "mug": likely}, can)
        solid = replace(solid, size=can.size, sure=0.5, frame_from_object=can.pose)
        mug = ObjectClass("mug", **sizes)
        _, (only,) = detected(mug, replace(look, solids=(solid,)), monkeypatch)
        scores.append(only.score)
    assert (scores[0] > 1.2 * scores[1]) == bool(sizes)

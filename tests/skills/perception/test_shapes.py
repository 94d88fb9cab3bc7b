"""Shapes: what stands on a table is told by its form, alone or touching something."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from momantu_skills.perception.objects.shapes import Shape, describe
from momantu_skills.perception.objects.splitting import split
from momantu_skills.perception.surface.planes import measure_support
from momantu_skills.perception.surface.segment import SegmentConfig, Thing, headroom, things_on

from momantu_bt.testing.painting import Block, Round, Solid
from tests.skills.scenery.onlooker import Viewed

TOP = 0.72
TABLE = Block((0.6, 1.2, 0.03), (1.0, 0.0, TOP - 0.015))


def at(x: float, y: float, height: float, radius: float, **more: Any) -> Round:
    return Round((x, y, TOP), height, radius, **more)


def things(viewed: Viewed, solids: list[Solid]) -> tuple[list[Thing], np.ndarray]:
    support = measure_support(viewed([TABLE, *solids], pans=(-0.15, 0.15)), 0.66, 0.78)
    assert support is not None
    return things_on(support), support.cameras - np.array([0.0, 0.0, support.height])


def shape(viewed: Viewed, solids: list[Solid]) -> Shape:
    found, eyes = things(viewed, solids)
    assert len(found) == 1
    return describe(found[0], eyes)


@pytest.mark.parametrize(
    ("category", "solids", "size"),
    [
        ("can", [at(0.95, 0.1, 0.13, 0.035)], (0.07, 0.07, 0.13)),
        ("can", [at(1.05, -0.2, 0.10, 0.045)], (0.09, 0.09, 0.10)),
        (
            "bottle",
            [
                at(0.95, 0.0, 0.15, 0.032),
                Round((0.95, 0.0, TOP + 0.15), 0.04, 0.032, 0.013),
                Round((0.95, 0.0, TOP + 0.19), 0.04, 0.013),
            ],
            (0.064, 0.064, 0.23),
        ),
        ("mug", [at(0.95, 0.1, 0.09, 0.04, hollow=True)], (0.08, 0.08, 0.09)),
        ("bowl", [at(0.9, 0.0, 0.06, 0.04, upper=0.075, hollow=True)], (0.149, 0.149, 0.055)),
        ("box", [Block((0.10, 0.06, 0.12), (0.95, 0.1, TOP + 0.06), 0.4)], (0.10, 0.06, 0.12)),
        ("box", [Block((0.07, 0.07, 0.13), (0.95, 0.1, TOP + 0.065), 0.0)], (0.07, 0.07, 0.13)),
    ],
)
def test_form_and_size(
    viewed: Viewed, category: str, solids: list[Solid], size: tuple[float, float, float]
) -> None:
    seen = shape(viewed, solids)
    assert seen.category == category
    assert sorted(seen.size[:2]) == pytest.approx(sorted(size[:2]), abs=0.006)
    assert seen.size[2] == pytest.approx(size[2], abs=0.006)


def test_a_handle_makes_a_mug(viewed: Viewed) -> None:
    handle = Block((0.03, 0.012, 0.06), (0.94, -0.05, TOP + 0.05), np.pi / 2)
    assert shape(viewed, [at(0.95, 0.0, 0.09, 0.04), handle]).category == "mug"


def test_the_expected_radius_serves_only_where_it_fits(viewed: Viewed) -> None:
    (thing,), eyes = things(viewed, [at(0.95, 0.1, 0.13, 0.035)])
    assert describe(thing, eyes, 0.035).size[0] == pytest.approx(0.07, abs=1e-9)
    assert describe(thing, eyes, 0.043).size[0] == pytest.approx(0.07, abs=0.003)


def test_things_apart_are_several_and_low_ones_none(viewed: Viewed) -> None:
    apart = [at(0.95, 0.0, 0.13, 0.035), at(0.95, 0.1, 0.13, 0.035), at(0.9, -0.3, 0.006, 0.05)]
    found, _ = things(viewed, apart)
    assert len(found) == 2


@pytest.mark.parametrize("bearing", [0.0, 0.8, 1.57])
def test_cans_that_touch_are_split(viewed: Viewed, bearing: float) -> None:
    apart = 0.074 * np.array([np.cos(bearing), np.sin(bearing)])
    first, second = np.array([0.93, -0.03]), np.array([0.93, -0.03]) + apart
    (clump,), eyes = things(viewed, [at(*first, 0.13, 0.035), at(*second, 0.15, 0.038)])
    parts = [describe(part, eyes) for part in split(clump, SegmentConfig())]
    round_ones = [part.centre for part in parts if part.kind == "cylinder"]
    assert min(np.hypot(*(first - c)) for c in round_ones) < 0.006
    assert min(np.hypot(*(second - c)) for c in round_ones) < 0.010


def test_one_can_is_not_split(viewed: Viewed) -> None:
    (thing,), _ = things(viewed, [at(0.95, 0.1, 0.13, 0.035)])
    assert len(split(thing, SegmentConfig())) == 1


def test_a_board_above_is_no_thing_and_joins_none(viewed: Viewed) -> None:
    below = Block((0.6, 1.2, 0.03), (1.0, 0.0, TOP - 0.015))
    above = Block((0.6, 1.2, 0.03), (1.25, 0.0, TOP + 0.425))
    views = viewed([below, above, at(0.85, 0.0, 0.12, 0.035)], pans=(-0.15, 0.15))
    support = measure_support(views, 0.66, 0.78)
    assert support is not None
    config = SegmentConfig()
    assert config.overhead < headroom(support, config) < 0.425
    found = [thing for thing in things_on(support, config) if len(thing.points) > 200]
    assert [thing.height for thing in found] == pytest.approx([0.12], abs=0.01)


def test_nothing_above_leaves_the_whole_ceiling(viewed: Viewed) -> None:
    box = Block((0.2, 0.2, 0.3), (0.95, 0.1, TOP + 0.15))
    support = measure_support(viewed([TABLE, box]), 0.66, 0.78)
    assert support is not None
    assert headroom(support, SegmentConfig()) == SegmentConfig().ceiling

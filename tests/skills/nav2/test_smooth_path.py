"""SmoothPath: ends stay, corners go, walls stay away."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from momantu_skills.nav2.smooth_path import SmoothPath
from momantu_skills.navigation.drive.ways import posed

from momantu_bt.geometry import Path, wrap_angle
from tests.skills.nav2.conftest import Act
from tests.skills.scenery.flat import START, Flat

CORNER = posed(np.array([(-2.5, 0.9), (-0.5, 0.9), (-0.5, -1.0)]), -1.5)


def _sharpest(path: Path) -> float:
    return max(abs(wrap_angle(b.yaw - a.yaw)) for a, b in pairwise(path))


def test_it_takes_the_corner_out(flat: Flat, act: Act) -> None:
    result = act(SmoothPath, flat(START), unsmoothed_path=CORNER)
    assert result.status == "SUCCESS", result.explain()
    path = result.outputs["smoothed_path"]
    assert (path[0].x, path[0].y) == pytest.approx((CORNER[0].x, CORNER[0].y))
    assert path[-1] == CORNER[-1]
    assert _sharpest(path) < 0.6 * _sharpest(CORNER)
    assert max(min(p.distance_to(q) for q in CORNER) for p in path) < 0.3
    assert result.outputs["was_completed"] is True


def test_it_does_not_move_the_path_into_a_wall(flat: Flat, act: Act) -> None:
    """Through the doorway and sharply round its post."""
    path = posed(np.array([(0.6, -0.6), (0.6, 0.85), (1.8, 0.85), (1.8, -0.6)]), -1.5)
    world = flat(START)
    result = act(SmoothPath, world, unsmoothed_path=path, check_for_collisions=True)
    assert result.status == "SUCCESS", result.explain()
    points = np.array([(p.x, p.y) for p in result.outputs["smoothed_path"]])
    assert world.robot.distance(points).min() > 0.18


WALL = posed(np.array([(-2.5, 0.9), (0.5, 0.0), (2.0, 0.0)]), 0.0)
CHECKED = {"unsmoothed_path": WALL, "check_for_collisions": True}


@pytest.mark.parametrize(
    ("inputs", "code", "number"),
    [
        ({"unsmoothed_path": ()}, "INVALID_PATH", 505),
        ({"unsmoothed_path": CORNER, "smoother_id": "magic"}, "INVALID_SMOOTHER", 501),
        ({"unsmoothed_path": CORNER, "max_smoothing_duration": 0.01}, "TIMEOUT", 502),
        (
            {"unsmoothed_path": WALL, "check_for_collisions": True},
            "SMOOTHED_PATH_IN_COLLISION",
            503,
        ),
    ],
)
def test_each_failure_has_nav2s_number(
    flat: Flat, act: Act, inputs: dict[str, Any], code: str, number: int
) -> None:
    result = act(SmoothPath, flat(START), **inputs)
    assert result.code == code, result.explain()
    assert result.skill.error_code_id == number  # type: ignore[union-attr]

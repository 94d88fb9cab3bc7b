"""Zones: distances from their borders, and what a file may say of them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from momantu_bt.descriptions.zones import ZoneNote
from momantu_bt.zone import Zone

HOOK = ((0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (2.0, 3.0), (2.0, 1.0), (0.0, 1.0))
"""An L: its notch is outside."""
NUMBERS = st.floats(-5.0, 5.0)


@given(NUMBERS, NUMBERS, st.booleans())
def test_the_sign_tells_inside_whichever_way_the_corners_go(x: float, y: float, back: bool) -> None:
    zone = Zone("keep_out", HOOK[::-1] if back else HOOK)
    away = float(zone.distance(np.array([[x, y]]))[0])
    inside = (0 < x < 3 and 0 < y < 1) or (2 < x < 3 and 0 < y < 3)
    if abs(away) > 1e-9:
        assert (away < 0.0) == inside


@given(NUMBERS, NUMBERS)
def test_the_distance_is_that_of_the_nearest_point_of_the_border(x: float, y: float) -> None:
    zone = Zone("slow", HOOK, 0.2)
    border = zone.border(0.01)
    nearest = float(np.hypot(*(border - (x, y)).T).min())
    assert abs(abs(float(zone.distance(np.array([[x, y]]))[0])) - nearest) < 0.0051


def test_points_of_the_border_lie_on_it_and_close_together() -> None:
    zone = Zone("keep_out", HOOK)
    border = zone.border(0.1)
    assert np.abs(zone.distance(border)).max() < 1e-12
    steps = np.hypot(*np.diff(np.vstack([border, border[:1]]), axis=0).T)
    assert steps.max() < 0.1 + 1e-9


def _note(**changes: Any) -> ZoneNote:
    told = {"kind": "keep_out", "corners": [[0, 0], ["1 m", 0], [1, "150 cm"]], **changes}
    return ZoneNote.model_validate(told)


def test_units_are_read() -> None:
    zone = _note(kind="slow", speed="20 cm/s").zone
    assert zone.corners == ((0.0, 0.0), (1.0, 0.0), (1.0, 1.5))
    assert zone.speed is not None
    assert math.isclose(zone.speed, 0.2)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"corners": [[0, 0], [1, 0]]}, "at least 3"),
        ({"corners": [[0, 0], [1, 1], [1, 0], [0, 1]]}, "from corner 1 and that from corner 3"),
        ({"corners": [[0, 0], [1, 0], [1, 0], [0, 1]]}, "corners 2 and 3 are the same"),
        ({"corners": [[0, 0], [1, 1], [0, 1], [0, 0]]}, "corners 4 and 1 are the same"),
        ({"corners": [[0, 0], [1, 1], [2, 2]]}, "lie on one line"),
        ({"corners": [[0, 0], [4, 0], [4, 2], [2, 0], [0, 2]]}, "sides cross"),
        ({"kind": "slow"}, "needs its `speed`, such as `speed: 0.3 m/s`"),
        ({"speed": 0.3}, "`speed` is for slow zones; this one is keep_out"),
        ({"kind": "slow", "speed": 0.01}, "greater than or equal to 0.05"),
        ({"kind": "forbidden"}, "'keep_out', 'slow' or 'preferred'"),
        ({"corners": [[0, 0], [1, 0], [1, math.nan]]}, "finite"),
    ],
)
def test_what_is_no_zone_is_refused(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(ValidationError, match=says):
        _note(**changes)

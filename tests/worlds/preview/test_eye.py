"""Where the view is taken from: all that matters is in the picture, and fills it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_worlds.display.chase import looking
from momantu_worlds.preview.view import AIR, FIELD, eye_over, towards

edges = st.floats(1.0, 60.0)


@given(edges, edges, st.floats(0.5, 4.0), st.floats(-50, 50), st.floats(-50, 50))
def test_every_corner_is_in_the_picture_and_the_sides_are_touched(
    wide: float, deep: float, high: float, x: float, y: float
) -> None:
    low, top = np.array([x, y, 0.0]), np.array([x + wide, y + deep, high])
    corners = np.array(np.meshgrid(*zip(low, top, strict=True))).reshape(3, -1).T
    turn = looking(towards(), np.zeros(3)).rotation
    eye, aspect = eye_over(corners, turn)
    own = (corners - eye) @ turn
    assert own[:, 0].min() > 0  # before the eye
    left = own[:, 1] / own[:, 0] / math.tan(FIELD / 2)
    up = own[:, 2] / own[:, 0] / math.tan(FIELD / 2)
    assert np.abs(left).max() <= 1.0
    assert np.abs(up).max() <= 1.001 * aspect
    assert (left.max(), -left.min()) == pytest.approx((1 / AIR, 1 / AIR))
    assert (up.max(), -up.min()) == pytest.approx((aspect / AIR, aspect / AIR))

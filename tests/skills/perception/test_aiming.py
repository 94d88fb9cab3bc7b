"""Aiming: the view's error is an angle, and the joints found lie within their limits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.perception.camera.aiming import aim, view_error

from momantu_bt.testing import small_robot

ROBOT = small_robot()
KINEMATICS = ROBOT.kinematics()
JOINTS = ROBOT.actuators["head"].joints
FRAME = ROBOT.camera()[1].frame
coordinate = st.floats(-3.0, 3.0)


@given(coordinate, coordinate, st.floats(-3.0, 3.0))
def test_the_error_is_the_angle_to_the_axis(x: float, y: float, z: float) -> None:
    point = np.array([x, y, z])
    length = float(np.linalg.norm(point))
    if length < 1e-3:
        return
    assert float(np.hypot(*view_error(point))) == pytest.approx(math.acos(z / length), abs=1e-6)


@settings(max_examples=40, deadline=None)
@given(coordinate, coordinate, st.floats(-0.5, 2.5), st.floats(-1.5, 1.5), st.floats(-0.7, 1.4))
def test_limits_are_kept_and_reachable_points_are_reached(
    x: float, y: float, z: float, pan: float, tilt: float
) -> None:
    point = np.array([x, y, z])
    start = {"pan": pan, "tilt": tilt, "lift": 0.1}
    aimed = aim(KINEMATICS, FRAME, JOINTS, ROBOT.joint_limits, start, point)
    for joint, value in zip(JOINTS, aimed.positions, strict=True):
        limit = ROBOT.joint_limits[joint]
        assert limit.lower is not None
        assert limit.upper is not None
        assert limit.lower <= value <= limit.upper
    moved = {**start, **dict(zip(JOINTS, aimed.positions, strict=True))}
    camera = KINEMATICS.base_from_frame(FRAME, moved)
    error = float(np.hypot(*view_error(camera.inverse().apply(point))))
    assert aimed.off_axis == pytest.approx(error, abs=1e-9)
    bearing, distance = math.atan2(y, x - 0.05), math.hypot(x - 0.05, y)
    if abs(bearing) < 1.4 and distance > 0.5 and abs(math.atan2(1.25 - z, distance)) < 0.6:
        assert aimed.off_axis < 1e-3

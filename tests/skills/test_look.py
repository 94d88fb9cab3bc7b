"""look: the optical axis goes through what is asked, or the skill says why not."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.look import Look

from momantu_bt.claim import CameraOn
from momantu_bt.geometry import Pose, Pose2D, Transform
from momantu_bt.testing import ScriptedRobot, run_skill, small_robot


def see(**arguments: Any) -> Any:
    """Run it; a planning scene is there, which a robot with a head never asks."""
    return run_skill(Look, services={"planning_scene": object()}, **arguments)


def off_axis(robot: ScriptedRobot, point: Any) -> float:
    """Angle in rad between the camera's axis and a point in odom."""
    frame = robot.description.camera()[1].frame
    camera = robot.description.kinematics().base_from_frame(frame, robot.joints)
    x, y, z = (robot.base.transform() @ camera).inverse().apply(point)
    return math.atan2(math.hypot(x, y), z)


def pose(point: Any, frame: str = "odom") -> Pose:
    return Pose(Transform(point), frame, 0.0)


@settings(max_examples=25, deadline=None)
@given(
    st.floats(0.6, 3.0),
    st.floats(-1.2, 1.2),
    st.floats(0.0, 1.5),
    st.floats(-3.0, 3.0),
)
def test_any_point_before_the_robot_ends_on_the_axis(
    distance: float, bearing: float, height: float, yaw: float
) -> None:
    robot = ScriptedRobot(base=Pose2D(1.0, -2.0, yaw))
    flat = (distance * math.cos(bearing), distance * math.sin(bearing), height)
    point = robot.base.transform().apply(flat)
    result = see(robot=robot, inputs={"at": pose(point)})
    assert result.status == "SUCCESS", result.explain()
    assert off_axis(robot, point) < 0.02
    assert all(abs(robot.speeds[j]) < 0.05 for j in ("pan", "tilt"))


def test_a_surface_is_looked_at_in_its_middle_at_its_height() -> None:
    robot = ScriptedRobot()
    map_from_odom = Pose2D(0.3, -0.2, 0.1).transform()
    result = see(robot=robot, inputs={"surface": "table_a"}, map_from_odom=map_from_odom)
    assert result.status == "SUCCESS", result.explain()
    assert off_axis(robot, map_from_odom.inverse().apply((2.0, 0.0, 0.7))) < 0.02


@pytest.mark.parametrize(("direction", "tilt"), [("ahead", 0.0), ("down", 0.93)])
def test_directions(direction: str, tilt: float) -> None:
    robot = ScriptedRobot(joints={"pan": 1.0, "tilt": 0.4})
    result = see(robot=robot, inputs={"direction": direction})
    assert result.status == "SUCCESS", result.explain()
    assert robot.joints["pan"] == pytest.approx(0.0, abs=0.02)
    assert robot.joints["tilt"] == pytest.approx(tilt, abs=0.05)


def test_looking_where_it_already_looks_takes_no_time() -> None:
    robot = ScriptedRobot()
    assert see(robot=robot, inputs={"direction": "ahead"}).ticks <= 2


@pytest.mark.parametrize(
    ("inputs", "says"),
    [
        ({}, "given: none"),
        ({"surface": "table_a", "direction": "down"}, "surface, direction"),
        ({"surface": "shelf"}, "table_a, table_b"),
    ],
)
def test_bad_targets_say_what_is_valid(inputs: dict[str, Any], says: str) -> None:
    result = see(inputs=inputs)
    assert result.code == "BAD_TARGET"
    assert says in result.explain()


def test_what_lies_behind_is_out_of_view() -> None:
    result = see(inputs={"at": pose((-2.0, 0.3, 1.0))})
    assert result.code == "OUT_OF_VIEW"
    assert "turn the robot" in result.explain()


def test_a_stuck_head_is_noticed_in_bounded_time() -> None:
    robot = ScriptedRobot()
    robot.frozen.add("head")
    result = see(robot=robot, inputs={"at": pose((1.0, 1.0, 0.5))})
    assert result.code == "OUT_OF_VIEW"
    assert "stuck" in result.explain()
    assert result.duration < 5.0


def test_a_fixed_camera_sees_what_lies_ahead_and_nothing_else() -> None:
    small = small_robot()
    camera = small.sensors["camera"].model_copy(update={"carrier": None})
    fixed = small.model_copy(update={"sensors": {**small.sensors, "camera": camera}})
    robot = ScriptedRobot(fixed, joints={"tilt": 0.4})
    height = fixed.kinematics().base_from_frame(camera.frame, robot.joints).position[2]
    ahead = (2.0, 0.0, height - 1.85 * math.tan(0.4))
    assert see(robot=robot, inputs={"at": pose(ahead)}).status == "SUCCESS"
    result = see(robot=robot, inputs={"at": pose((2.0, 1.0, 1.0))})
    assert result.code == "OUT_OF_VIEW"
    assert "the camera is fixed" in result.explain()
    assert robot.commands == []


def test_looking_is_claimed_of_the_point_whether_said_or_denied() -> None:
    robot, stuck = ScriptedRobot(), ScriptedRobot()
    stuck.frozen.add("head")
    point = (1.0, 1.0, 0.5)
    for looking, code in ((robot, None), (stuck, "OUT_OF_VIEW")):
        result = see(robot=looking, inputs={"at": pose(point)})
        assert result.code == code
        claim = result.claim()
        assert isinstance(claim, CameraOn)
        assert claim.odom_point == pytest.approx(point)
        assert claim.frame == looking.description.camera()[1].frame
        assert (off_axis(looking, claim.odom_point) <= claim.turn_tolerance) is (code is None)
    assert see(inputs={"surface": "shelf"}).claim() is None

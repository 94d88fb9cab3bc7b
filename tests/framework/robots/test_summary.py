"""What `robots show` tells adds up, for a person and for a program."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from momantu_bt.cli import main
from momantu_bt.robots import read_robot
from momantu_bt.robots.summary import summary
from momantu_bt.testing.description import small_robot

Write = Callable[..., Path]
ANY = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=30)


def test_masses_links_and_joints_of_the_parts_add_up(carter: Write) -> None:
    about = summary(read_robot(carter()))
    parts = about["parts"].values()
    assert (
        about["mass"] == pytest.approx(sum(part["mass"] for part in parts)) == pytest.approx(33.7)
    )
    assert [part["links"] for part in parts] == [2, 5]
    assert about["parts"]["arm"]["mount"]["on"] == "base_link"
    assert about["footprint"] == {"length": 0.5, "width": 0.4}
    assert about["sensors"]["camera"]["height_at_home"] == pytest.approx(0.8)
    assert about["joint_limits"]["arm_left_slide"]["unit"] == "m"
    assert about["simulated"]


@ANY
@given(st.floats(-1.5, 1.5), st.floats(-10, 10))
def test_no_posture_reaches_beyond_the_stretched_arm(
    carter: Write, turn: float, bend: float
) -> None:
    robot = read_robot(carter())
    kinematics = robot.kinematics()
    joints = {"arm_turn": turn, "arm_bend": bend}
    tip, first = (kinematics.base_from_frame(f, joints).position for f in ("hand", "arm_shoulder"))
    stretched = summary(robot)["groups"]["arm"]["stretched"]
    assert np.linalg.norm(tip - first) <= stretched + 1e-9
    assert stretched == pytest.approx(0.65)


def test_a_description_without_a_file_is_told_without_parts() -> None:
    about = summary(small_robot())
    assert (about["file"], about["parts"], about["simulated"]) == (None, {}, False)
    assert json.loads(json.dumps(about))["name"] == "small"


def test_the_text_says_what_the_data_says(
    carter: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["robots", "show", str(carter())]) == 0
    text = capsys.readouterr().out
    for words in (
        "mass        33.7 kg",
        "cart: cart.urdf; 2 links, 0 joints, 30.0 kg",
        "arm: arm.urdf.xacro; names begin with arm_; 5 links, 4 joints, 3.7 kg; on base_link",
        "arm_bend: endless, 1.05 rad/s, 1.5 rad/s2",
        "camera: camera, in lens, 0.80 m high at home; 640 x 480, 60 degrees wide;",
        "opens to 80 mm, closes with up to 20 N",
    ):
        assert words in text

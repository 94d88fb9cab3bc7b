"""Numbers and poses of SDF are what the format says, and nothing else is taken for one."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_worlds.sdf.errors import SdfError
from momantu_worlds.sdf.read.document import parse_document
from momantu_worlds.sdf.read.values import color_of, flag, lengths, number, pose_of, vector
from momantu_worlds.sdf.write.writing import rpy

from momantu_bt.geometry import Transform

ANGLE = st.floats(-10, 10)


def element(inside: str):
    return parse_document(f"<x>{inside}</x>".encode(), Path("x.sdf"))


@given(st.tuples(*[st.floats(-50, 50)] * 3, ANGLE, ANGLE, ANGLE))
def test_a_pose_is_x_y_z_and_turns_about_fixed_axes(pose):
    text = " ".join(map(repr, pose))
    found = pose_of(element(f"<pose>{text}</pose>")).transform
    x, y, z = (
        np.array(
            [
                [1, 0, 0],
                [0, math.cos(pose[3]), -math.sin(pose[3])],
                [0, math.sin(pose[3]), math.cos(pose[3])],
            ]
        ),
        np.array(
            [
                [math.cos(pose[4]), 0, math.sin(pose[4])],
                [0, 1, 0],
                [-math.sin(pose[4]), 0, math.cos(pose[4])],
            ]
        ),
        np.array(
            [
                [math.cos(pose[5]), -math.sin(pose[5]), 0],
                [math.sin(pose[5]), math.cos(pose[5]), 0],
                [0, 0, 1],
            ]
        ),
    )
    assert found.rotation == pytest.approx(z @ y @ x, abs=1e-9)
    assert found.position == pytest.approx(pose[:3])


@given(ANGLE, ANGLE, ANGLE)
def test_written_angles_make_the_same_rotation(roll, pitch, yaw):
    turned = Transform.from_rpy((0, 0, 0), (roll, pitch, yaw))
    assert Transform.from_rpy((0, 0, 0), rpy(turned)).rotation == pytest.approx(
        turned.rotation, abs=1e-6
    )


@pytest.mark.parametrize("pitch", [math.pi / 2, -math.pi / 2])
def test_written_angles_where_x_points_up_or_down(pitch):
    turned = Transform.from_rpy((0, 0, 0), (0.3, pitch, 1.1))
    again = Transform.from_rpy((0, 0, 0), rpy(turned))
    assert again.rotation == pytest.approx(turned.rotation, abs=1e-6)


def test_degrees_and_quaternions_are_other_spellings():
    plain = pose_of(element("<pose>1 2 3 0 0 1.5707963267948966</pose>")).transform
    degrees = pose_of(element("<pose degrees='true'>1 2 3 0 0 90</pose>")).transform
    quaternion = pose_of(
        element("<pose rotation_format='quat_xyzw'>1 2 3 0 0 0.70710678 0.70710678</pose>")
    ).transform
    assert degrees.matrix == pytest.approx(plain.matrix)
    assert quaternion.matrix == pytest.approx(plain.matrix, abs=1e-7)


def test_a_pose_that_is_not_there_is_the_identity():
    assert pose_of(element("")).transform == Transform()
    assert pose_of(element("<pose relative_to='a'/>")).relative_to == "a"


@pytest.mark.parametrize(
    ("pose", "words"),
    [
        ("<pose>1 2 3</pose>", "3 numbers; expected 6"),
        ("<pose>nan 0 0 0 0 0</pose>", "'nan'; expected a finite number"),
        ("<pose>0 inf 0 0 0 0</pose>", "finite"),
        ("<pose>1 2 3 a 0 0</pose>", "'a'; expected a number"),
        ("<pose>1e9 0 0 0 0 0</pose>", "m away"),
        ("<pose rotation_format='quat_xyzw'>0 0 0 0 0 0 0</pose>", "without length"),
        ("<pose rotation_format='axis'>0 0 0 0 0 0</pose>", "rotation_format 'axis'"),
    ],
)
def test_a_pose_that_is_none_is_told(pose, words):
    with pytest.raises(SdfError, match=words):
        pose_of(element(pose))


def test_lengths_are_above_zero_and_there():
    assert lengths(element("<size>1 2 3</size>"), "size", 3) == (1, 2, 3)
    for inside, words in (
        ("", "needs a <size>"),
        ("<size>1 -2 3</size>", "expected a length above 0"),
        ("<size>1 2</size>", "2 numbers; expected 3"),
        ("<size>0 1 1</size>", "expected a length above 0"),
    ):
        with pytest.raises(SdfError, match=words):
            lengths(element(inside), "size", 3)


def test_other_values():
    inside = element("<a>true</a><b>0</b><c>1.5</c><d>1 2</d><e>.5 .5 .5</e><f>maybe</f>")
    assert flag(inside, "a")
    assert not flag(inside, "b")
    assert flag(inside, "z", default=True)
    assert number(inside, "c", 2.0) == 1.5
    assert number(inside, "z", 2.0) == 2.0
    assert vector(inside, "d", (0, 0)) == (1, 2)
    assert color_of(inside, "e") == (0.5, 0.5, 0.5, 1.0)
    for wrong in (lambda: flag(inside, "f"), lambda: color_of(inside, "d")):
        with pytest.raises(SdfError):
            wrong()

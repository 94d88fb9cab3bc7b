"""A robot file's calibration moves what skills believe, and nothing that a simulator builds."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from momantu_bt.geometry import Transform
from momantu_bt.robot import WheelCorrection
from momantu_bt.robots import RobotFileError, read_robot

Write = Callable[..., Path]


def with_calibration(carter: Write, text: str) -> Path:
    file = carter()
    file.write_text(file.read_text("utf-8") + f"\ncalibration: {text}\n", "utf-8")
    return file


def test_a_zero_is_added_to_what_the_joint_reports(carter: Write) -> None:
    before = read_robot(carter())
    tree = before.kinematics()
    for joint in tree.chain(before.hand.frame):
        if joint.kind == "fixed":
            continue
        after = read_robot(with_calibration(carter, f"{{joints: {{{joint.name}: 0.1}}}}"))
        moved = after.kinematics().base_from_frame(before.hand.frame, {joint.name: 0.2})
        exact = tree.base_from_frame(before.hand.frame, {joint.name: 0.3})
        assert moved.matrix == pytest.approx(exact.matrix, abs=1e-9)
        assert after.simulation is not None
        assert after.simulation.urdf == before.urdf


def test_a_camera_is_moved_in_its_own_frame(carter: Write) -> None:
    before = read_robot(carter())
    name, camera = before.camera()
    text = f"{{cameras: {{{name}: {{xyz: [1 cm, 0, 0], rpy: [0, 2 deg, 0]}}}}}}"
    after = read_robot(with_calibration(carter, text))
    move = Transform.from_rpy((0.01, 0.0, 0.0), (0.0, 0.0349066, 0.0))
    exact = before.kinematics().base_from_frame(camera.frame, {}) @ move
    there = after.kinematics().base_from_frame(camera.frame, {})
    assert there.matrix == pytest.approx(exact.matrix, abs=1e-6)


def test_wheels_are_told_to_the_driver_and_change_no_link(carter: Write) -> None:
    before = read_robot(carter())
    assert before.wheels is None
    text = "{wheels: {radius: 0.01, left_to_right: -0.02, between: 40 cm}}"
    after = read_robot(with_calibration(carter, text))
    assert after.wheels == WheelCorrection(radius=0.01, left_to_right=-0.02, between=0.4)
    frame = before.hand.frame
    there = after.kinematics().base_from_frame(frame, {}).matrix
    assert there == pytest.approx(before.kinematics().base_from_frame(frame, {}).matrix, abs=1e-9)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{wheels: {radius: 2.0, between: 0.4}}", "radius"),
        ("{wheels: {radius: 0.01}}", "between"),
        ("{joints: {elbow: 0.1}}", "there is no joint 'elbow' that moves; "),
        ("{cameras: {eye: {xyz: [0, 0, 0]}}}", "there is no camera 'eye'; "),
        ("{joints: {elbow: nan}}", "calibration"),
    ],
)
def test_what_does_not_fit_is_refused_at_its_place(carter: Write, text: str, message: str) -> None:
    with pytest.raises(RobotFileError, match=message):
        read_robot(with_calibration(carter, text))

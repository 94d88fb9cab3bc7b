"""Joints that mimic others stand where the URDF says, and have no motor of their own."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from momantu_worlds.sapien.config import Physics
from momantu_worlds.sapien.drives.followers import Followers, mimicking

from momantu_bt.robot import ActuatorKind

PHYSICS = Physics()


class FakeJoint:
    """Keeps what it was told."""

    target = 0.0
    gains: tuple[float, ...] = ()

    def set_drive_target(self, target: float) -> None:
        self.target = target

    def set_drive_property(self, *gains: float) -> None:
        self.gains = gains


def described(folder: Path, *driven: str, kind: ActuatorKind = ActuatorKind.JOINTS) -> Any:
    source = folder / "robot.urdf"
    joints = "".join(
        f'<joint name="{name}" type="revolute"><parent link="a"/><child link="{name}_link"/>'
        f'<limit lower="-2" upper="2" effort="1" velocity="1"/>{extra}</joint>'
        for name, extra in (
            ("leader", ""),
            ("follower", '<mimic joint="leader" multiplier="-0.5" offset="0.1"/>'),
        )
    )
    links = "".join(f'<link name="{name}"/>' for name in ("a", "leader_link", "follower_link"))
    source.write_text(f'<robot name="r">{links}{joints}</robot>')
    actuators = {"arm": SimpleNamespace(kind=kind, joints=driven)}
    return SimpleNamespace(urdf=source, actuators=actuators, end_effector=None)


@pytest.mark.parametrize("at", [-1.5, 0.0, 0.3])
def test_a_joint_that_mimics_another_follows_it(tmp_path: Path, at: float) -> None:
    joints = {"leader": FakeJoint(), "follower": FakeJoint()}
    found = mimicking(described(tmp_path, "leader"), joints, {"leader": 2, "follower": 0}, PHYSICS)
    assert list(found) == ["follower"]
    assert joints["follower"].gains == (PHYSICS.tendon_stiffness, PHYSICS.tendon_damping)
    Followers(found.values()).follow(np.array([9.0, 9.0, at]))
    assert joints["follower"].target == pytest.approx(0.1 - 0.5 * at)


def test_a_joint_that_an_actuator_moves_follows_nothing(tmp_path: Path) -> None:
    joints = {"leader": FakeJoint(), "follower": FakeJoint()}
    index = {"leader": 0, "follower": 1}
    both = described(tmp_path, "leader", "follower")
    assert mimicking(both, joints, index, PHYSICS) == {}


def test_a_finger_of_a_gripper_that_is_no_end_effector_follows(tmp_path: Path) -> None:
    joints = {"leader": FakeJoint(), "follower": FakeJoint()}
    second = described(tmp_path, "leader", "follower", kind=ActuatorKind.GRIPPER)
    assert list(mimicking(second, joints, {"leader": 0, "follower": 1}, PHYSICS)) == ["follower"]

"""Joints without a motor of their own: they stand where the joint that leads them is."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from momantu_bt.formats.urdf import read_urdf
from momantu_bt.geometry import Array
from momantu_bt.robot import Actuator, ActuatorKind, RobotDescription
from momantu_worlds.sapien.config import Physics

FAR = 1e4
"""Largest position of a leading joint, rad or m."""


@dataclass(frozen=True, slots=True)
class Follower:
    """A joint that follows another one.

    joint: SAPIEN's; its drive is as stiff as the gears or bars that move it. place: the leader's
    index in qpos. leads, own: (n,) positions of the leader, rising, and those of the joint, rad or
    m.
    """

    joint: Any
    place: int
    leads: Array
    own: Array

    def where(self, positions: Array) -> float:
        """Its position, rad or m, while all joints stand at `positions` (dof,)."""
        return float(np.interp(positions[self.place], self.leads, self.own))


class Followers:
    """Sends joints that follow others to where they belong."""

    def __init__(self, followers: Iterable[Follower]) -> None:
        self._followers = tuple(followers)

    def follow(self, positions: Array) -> None:
        """Follow their leaders for one physics step; positions: of all joints now (dof,)."""
        for each in self._followers:
            each.joint.set_drive_target(each.where(positions))


def unused_grippers(description: RobotDescription) -> dict[str, Actuator]:
    """The grippers that are not the end effector's, such as a second arm's: no command moves them.

    Without a drive their fingers would dangle.
    """
    hand = description.end_effector
    return {
        name: actuator
        for name, actuator in description.actuators.items()
        if actuator.kind is ActuatorKind.GRIPPER and (hand is None or name != hand.actuator)
    }


def mimicking(
    description: RobotDescription,
    joints: Mapping[str, Any],
    index: Mapping[str, int],
    physics: Physics,
) -> dict[str, Follower]:
    """The joints that mimic others in the URDF and that no actuator moves, by name.

    joints: SAPIEN's.
    """
    idle = unused_grippers(description)
    driven = {
        joint
        for name, actuator in description.actuators.items()
        if name not in idle
        for joint in actuator.joints
    }
    leads, found = np.array([-FAR, FAR]), {}
    for one in read_urdf(description.urdf).joints:
        mimic = one.mimic
        if mimic is None or one.name in driven or not {one.name, mimic.leader} <= {*joints}:
            continue
        joint = joints[one.name]
        joint.set_drive_property(physics.tendon_stiffness, physics.tendon_damping)
        own = mimic.multiplier * leads + mimic.offset
        found[one.name] = Follower(joint, index[mimic.leader], leads, own)
    return found

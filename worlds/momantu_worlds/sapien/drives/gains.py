"""Gains and limits of a robot's joints: from its description, or defaults."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from momantu_bt.formats.urdf import read_urdf
from momantu_bt.robot import JointGains, RobotDescription, SimulationModel
from momantu_worlds.sapien.config import Physics


@dataclass(frozen=True, slots=True)
class Gains:
    """A position drive: stiffness (Nm/rad or N/m), damping, largest force (Nm or N), armature."""

    stiffness: float
    damping: float
    force: float
    armature: float

    def give(self, joint: Any, force: float | None = None) -> None:
        """Set a joint of SAPIEN's; `force` replaces the usual limit."""
        joint.set_drive_property(
            self.stiffness, self.damping, self.force if force is None else force
        )
        if self.armature > 0.0:
            joint.set_armature([self.armature])


def arm_gains(
    description: RobotDescription, simulation: SimulationModel, physics: Physics
) -> Mapping[str, Gains]:
    """Gains of every joint that the description limits or drives, by name."""
    efforts = _efforts(description)
    names = {*description.joint_limits, *simulation.drives}
    return {
        name: with_own(
            simulation.drives.get(name),
            Gains(physics.arm_stiffness, physics.arm_damping, efforts.get(name, math.inf), 0.0),
        )
        for name in sorted(names)
    }


def with_own(own: JointGains | None, usual: Gains) -> Gains:
    """The usual gains, with a joint's own values replacing them."""
    if own is None:
        return usual
    return Gains(
        usual.stiffness if own.stiffness is None else own.stiffness,
        usual.damping if own.damping is None else own.damping,
        usual.force if own.force is None else own.force,
        own.armature,
    )


def _efforts(description: RobotDescription) -> dict[str, float]:
    """The URDF's effort limits, by joint; a limit of 0 counts as not given."""
    joints = read_urdf(description.urdf).joints
    return {joint.name: joint.effort for joint in joints if joint.effort}

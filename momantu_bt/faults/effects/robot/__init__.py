"""Faults at the robot's boundary: any robot, wrapped in one layer for each fault."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TypeAlias

from momantu_bt.fault import Fault, FaultError
from momantu_bt.faults.effects.robot import arm, base, camera, gripper, odometry, sensors, wheel
from momantu_bt.faults.effects.robot.layer import Layer
from momantu_bt.robot import Robot

LayerType: TypeAlias = type[Layer]

LAYERS: Mapping[str, LayerType] = MappingProxyType(
    {
        "camera.dead": sensors.DeadCamera,
        "camera.frozen": sensors.FrozenCamera,
        "camera.dark": camera.Dark,
        "camera.biased": camera.Biased,
        "camera.noisier": camera.Noisier,
        "camera.shifted": camera.Shifted,
        "laser.dead": sensors.DeadLaser,
        "laser.stuck": sensors.StuckLaser,
        "laser.blocked": sensors.BlockedLaser,
        "odometry.slip": odometry.Slip,
        "odometry.bias": odometry.Bias,
        "base.stuck": base.Stuck,
        "base.slow": base.Slow,
        "base.offset": base.Offset,
        "base.wheel": wheel.Larger,
        "arm.stuck": arm.Stuck,
        "arm.slow": arm.Slow,
        "arm.offset": arm.Offset,
        "gripper.weak": gripper.Weak,
        "gripper.stuck": gripper.Stuck,
        "gripper.slips": gripper.Slips,
    }
)
"""By the fault's name."""


def layer(robot: Robot, fault: Fault, seed: int) -> Layer:
    """The robot in a layer whose fault has not begun.

    Raises:
        FaultError: the robot lacks the part that the fault breaks.
    """
    try:
        return LAYERS[fault.name](robot, fault, seed)
    except KeyError as error:
        raise FaultError(f"{fault.name} on {robot.description.name}: {error.args[0]}") from None

"""What joint encoders, motor currents and the gripper's gauge report."""

from __future__ import annotations

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.robot import RobotDescription
from momantu_bt.world import seeded
from momantu_worlds.sapien.config import JointErrors


class Encoders:
    """Adds constant offsets and noise to true joint values.

    offsets (n,): measured minus true, in the order of `names`.
    """

    def __init__(
        self, names: tuple[str, ...], prismatic: Array, seed: int, errors: JointErrors
    ) -> None:
        self._seed, self._errors = seed, errors
        random = seeded(seed, "joint offsets")
        scale = np.where(prismatic, errors.offset_prismatic, errors.offset)
        self.offsets = scale * random.standard_normal(len(names))
        self._width_bias = errors.width_bias * float(random.standard_normal())

    def joints(
        self, positions: Array, velocities: Array, efforts: Array, stamp: float
    ) -> tuple[Array, Array, Array]:
        """Measured positions, velocities and efforts, each (n,)."""
        noise = seeded(self._seed, "joints", stamp).standard_normal((3, len(positions)))
        e = self._errors
        return (
            positions + self.offsets + e.noise * noise[0],
            velocities + e.velocity_noise * noise[1],
            efforts + e.effort_noise * noise[2],
        )

    def gripper(self, width: float, effort: float, stamp: float) -> tuple[float, float]:
        """Measured opening (m, never below 0) and closing force (N)."""
        noise = seeded(self._seed, "gripper", stamp).standard_normal(2)
        e = self._errors
        measured = width + self._width_bias + e.width_noise * float(noise[0])
        return max(0.0, measured), effort + e.grip_noise * float(noise[1])


def prismatic_joints(description: RobotDescription, names: tuple[str, ...]) -> Array:
    """(n,) bool: which of the named joints slide."""
    from lxml import etree

    root = etree.fromstring(description.urdf.read_bytes())
    kinds = {str(j.get("name")): str(j.get("type")) for j in root.findall("joint")}
    return np.array([kinds.get(name) == "prismatic" for name in names])

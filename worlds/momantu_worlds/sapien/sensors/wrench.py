"""Force and torque at the wrist, as a sensor between arm and hand measures them."""

from __future__ import annotations

from typing import Any

import numpy as np

from momantu_bt.geometry import Array, matrix_from_quaternion
from momantu_bt.messages import WrenchReading, frozen
from momantu_bt.robot import WristWrench
from momantu_bt.world import seeded
from momantu_worlds.sapien.config import WrenchErrors


class Wrench:
    """The load of the hand on the wrist; the hand's own weight is compensated."""

    def __init__(
        self,
        articulation: Any,
        bearing: Any,
        link: Any,
        name: str,
        sensor: WristWrench,
        seed: int,
        errors: WrenchErrors,
    ) -> None:
        """bearing: the link whose joint is measured. link: that of the sensor, often the same."""
        self._articulation, self._index = articulation, bearing.get_index()
        self._bearing, self._link = bearing, link
        self._link_from_joint = matrix_from_quaternion(bearing.get_joint().get_pose_in_child().q)
        self._name, self._sensor, self._seed, self._errors = name, sensor, seed, errors
        self._sum = np.zeros(6)
        self._count = 0
        random = seeded(seed, name, "bias")
        self._force_bias = errors.force_bias * random.standard_normal(3)
        self._torque_bias = errors.torque_bias * random.standard_normal(3)

    def read(self, stamp: float) -> WrenchReading:
        """Read the wrench now, in the sensor's frame."""
        force, torque = self.exact()
        random, errors = seeded(self._seed, self._name, stamp), self._errors
        force = force + self._force_bias + errors.force_noise * random.standard_normal(3)
        torque = torque + self._torque_bias + errors.torque_noise * random.standard_normal(3)
        return WrenchReading(
            stamp, self._sensor.frame, np.asarray(frozen(force)), np.asarray(frozen(torque))
        )

    def begin_tick(self) -> None:
        """Start a new average."""
        self._sum[:] = 0.0
        self._count = 0

    def collect(self) -> None:
        """Add the last physics step."""
        self._sum += self._articulation.get_link_incoming_joint_forces()[self._index]
        self._count += 1

    def exact(self) -> tuple[Array, Array]:
        """Force (3,) N and torque (3,) Nm without errors, averaged over the last tick.

        The average is necessary: the contact solver of a grasp alternates by 1 N from step to step.
        The joint carries the hand, so the load on it is the negative of the reaction.
        """
        mean = -self._sum / max(self._count, 1)
        force, torque = self._link_from_joint @ mean[:3], self._link_from_joint @ mean[3:]
        if self._link is self._bearing:
            return force, torque
        between = self._link.get_entity_pose().inv() * self._bearing.get_entity_pose()
        rotation = matrix_from_quaternion(between.q)
        force = rotation @ force
        joint = between.p + rotation @ self._bearing.get_joint().get_pose_in_child().p
        return force, rotation @ torque + np.cross(joint, force)

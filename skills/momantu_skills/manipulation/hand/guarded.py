"""Guarded motions: follow a trajectory until the hand feels a force."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.messages import JointPositions, JointTrajectory
from momantu_bt.robot import ARM, Robot
from momantu_skills.manipulation.arm import Arm
from momantu_skills.manipulation.hand.gripper import wrist_force

RESTING = 5
"""Ticks at rest over which the load before the motion is averaged."""
AFTER = 6
"""Ticks after the stop in which the force may still grow."""


@dataclass(frozen=True, slots=True)
class Contact:
    """How a guarded motion ended.

    felt: whether the force reached the limit; False: the motion came to its end without. force: the
    force (x, y, z) on the hand at its greatest, without the load at the start, odom, N. travel: how
    far the hand moved, m.
    """

    felt: bool
    force: tuple[float, float, float]
    travel: float

    @property
    def strength(self) -> float:
        """Amount of the greatest force, N."""
        return float(np.linalg.norm(self.force))


def hand_force(arm: Arm) -> Array:
    """Force (3,) on the hand, odom, N: measured at the wrist, or estimated from joint efforts.

    The estimate takes the contact to be between the pads and solves `efforts = -J^T force` by least
    squares. It is relative: compare two of them.
    """
    measured = wrist_force(arm.robot, arm.skill.frames)
    if measured is not None:
        return measured
    state, model = arm.state, arm.scene.model
    efforts = np.array([state.efforts[state.names.index(name)] for name in arm.group.names])
    jacobian = arm.group.jacobian(arm.joints)
    lever = arm.group.tip_matrix(arm.joints)[:3, :3] @ model.tip_from_grasp.position
    linear = jacobian[:3] + np.cross(jacobian[3:].T, lever).T
    base_force, *_ = np.linalg.lstsq(linear.T, -efforts, rcond=1e-2)
    return np.asarray(state.odom_from_base.rotation @ base_force)


def rested_load(arm: Arm, phase: str = "feeling") -> Generator[str, None, Array]:
    """Mean force (3,) on the hand over some ticks at rest, odom, N."""
    forces = []
    for _ in range(RESTING):
        forces.append(hand_force(arm))
        yield phase
    return np.asarray(np.mean(forces, axis=0))


def until_force(
    arm: Arm, trajectory: JointTrajectory, limit: float, phase: str
) -> Generator[str, None, Contact]:
    """Follow a trajectory; brake as soon as the force on the hand has changed by `limit` N.

    The arm stops about 0.1 s after the contact: one tick until it is measured, one for the command.
    So the force overshoots by what the arm and the obstacle yield over that way. Then the arm holds
    the joints that it has reached, so that it does not go on pushing.

    Raises:
        Failure: ARM_STUCK.
    """
    rest = yield from rested_load(arm)
    start = _grasp_point(arm)
    greatest = np.zeros(3)

    def felt(robot: Robot) -> bool:
        nonlocal greatest
        change = hand_force(arm) - rest
        if np.linalg.norm(change) > np.linalg.norm(greatest):
            greatest = change
        return bool(np.linalg.norm(change) > limit)

    arrived = yield from arm.follow(trajectory, phase, felt)
    if not arrived:
        arm.service.touched()
        here = JointPositions(arm.group.names, tuple(float(q) for q in arm.joints))
        for _ in range(AFTER):
            felt(arm.robot)
            arm.robot.command(ARM, here)
            yield phase
    x, y, z = (float(part) for part in greatest)
    travel = float(np.linalg.norm(_grasp_point(arm) - start))
    return Contact(not arrived, (x, y, z), travel)


def _grasp_point(arm: Arm) -> Array:
    """The point between the pads, base frame, m."""
    grasp = arm.group.tip_pose(arm.joints) @ arm.scene.model.tip_from_grasp
    return np.asarray(grasp.position)

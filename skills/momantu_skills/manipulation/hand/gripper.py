"""Opening and closing the gripper, and measuring the load on the wrist."""

from __future__ import annotations

from collections.abc import Callable, Generator

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.frames import ODOM, FrameBuffer
from momantu_bt.geometry import Array
from momantu_bt.messages import GripperCommand
from momantu_bt.robot import Robot
from momantu_bt.skill import Clock
from momantu_skills.manipulation.scene.payload import wrist_sensor

RESTING = 3
"""Successive ticks without movement after which the fingers count as at rest."""
MOVEMENT = 1.5e-3
"""Change between two ticks that counts as movement, m: three sigma of the width's noise."""
PRESSING = 0.7
"""Share of the force limit above which the fingers press on something."""
OPEN_TOLERANCE = 0.006
"""Largest distance from the wanted opening at which the gripper counts as open, m."""


def move_gripper(
    robot: Robot, clock: Clock, width: float, force: float, timeout: float, phase: str
) -> Generator[str, None, float]:
    """Move the fingers to `width` or until they press on something; return the opening reached, m.

    It never fails: the caller decides what the opening means. Opening ends only at the width,
    because it begins with a release of force, during which nothing moves.
    """
    actuator = robot.description.hand.actuator
    goal = GripperCommand(width, force)
    began, still, last = clock.now(), 0, robot.state().gripper_width
    closing = width < last
    while still < RESTING and clock.now() - began < timeout:
        robot.command(actuator, goal)
        yield phase
        state = robot.state()
        there = abs(state.gripper_width - width) < OPEN_TOLERANCE
        pressing = closing and state.gripper_effort > PRESSING * force
        resting = abs(state.gripper_width - last) < MOVEMENT and (there or pressing)
        still, last = still + 1 if resting else 0, state.gripper_width
    return float(robot.state().gripper_width)


def wrist_force(robot: Robot, frames: FrameBuffer) -> Array | None:
    """Force (3,) of the load on the wrist, in odom, N; None on robots without a force sensor."""
    name = wrist_sensor(robot.description)
    if name is None:
        return None
    reading = robot.read(name)
    rotation = frames.lookup(ODOM, reading.frame, reading.stamp).rotation
    return np.asarray(rotation @ reading.force)  # type: ignore[union-attr]


def rested_force(
    robot: Robot, frames: FrameBuffer, phase: str, ticks: int = 5
) -> Generator[str, None, Array | None]:
    """Mean force on the wrist over some ticks at rest, in odom, N."""
    forces = []
    for _ in range(ticks):
        force = wrist_force(robot, frames)
        if force is None:
            return None
        forces.append(force)
        yield phase
    return np.asarray(np.mean(forces, axis=0))


def bump(
    frames: FrameBuffer, rest: Array | None, limit: float, vertical: bool = False
) -> Callable[[Robot], bool] | None:
    """A function that returns True when the force differs from `rest` by more than `limit` N.

    vertical: use only the upward change. None if the robot has no force sensor.
    """
    if rest is None:
        return None
    baseline = rest

    def felt(robot: Robot) -> bool:
        force = wrist_force(robot, frames)
        if force is None:
            return False
        change = force - baseline
        return bool(change[2] > limit if vertical else np.linalg.norm(change) > limit)

    return felt


def open_hand(
    robot: Robot, clock: Clock, width: float, force: float, timeout: float
) -> Generator[str, None, None]:
    """Open to `width`.

    Raises:
        Failure: GRIPPER_STUCK if the fingers do not reach the width.
    """
    reached = yield from move_gripper(robot, clock, width, force, timeout, "opening")
    if reached < width - 2 * OPEN_TOLERANCE:
        raise Failure(
            "GRIPPER_STUCK",
            f"the gripper opened to {reached * 1000:.0f} mm of {width * 1000:.0f} mm",
            reached=reached,
            asked=width,
        )

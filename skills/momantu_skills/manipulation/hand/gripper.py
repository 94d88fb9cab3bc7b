"""Opening and closing the gripper, and feeling what the wrist carries."""

from __future__ import annotations

from collections.abc import Callable, Generator

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.frames import ODOM, FrameBuffer
from momantu_bt.geometry import Array
from momantu_bt.messages import GripperCommand
from momantu_bt.robot import Robot, WristWrench
from momantu_bt.skill import Clock

RESTING = 3
"""Ticks in a row without movement after which the fingers have come to rest."""
MOVEMENT = 1.5e-3
"""m of change between two ticks that is movement: three sigma of the width's noise."""
PRESSING = 0.7
"""Share of the force limit at which the fingers press on something."""
OPEN_TOLERANCE = 0.006
"""m from the asked opening at which the gripper counts as open."""


def move_gripper(
    robot: Robot, clock: Clock, width: float, force: float, timeout: float, phase: str
) -> Generator[str, None, float]:
    """Move the fingers until they are at `width` or press on something; the opening reached, m.

    Never fails: what the opening means is the caller's to judge. Opening ends only at the width,
    for it begins with letting the force go, during which nothing moves.
    """
    actuator = robot.description.end_effector.actuator
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
    """Force (3,) that the load puts on the wrist, in odom, N; None on robots that cannot feel."""
    name = next(
        (n for n, s in robot.description.sensors.items() if isinstance(s, WristWrench)), None
    )
    if name is None:
        return None
    reading = robot.read(name)
    rotation = frames.lookup(ODOM, reading.frame, reading.stamp).rotation
    return np.asarray(rotation @ reading.force)  # type: ignore[union-attr]


def rested_force(
    robot: Robot, frames: FrameBuffer, phase: str, ticks: int = 5
) -> Generator[str, None, Array | None]:
    """Mean of the wrist's force over some ticks at rest, in odom, N."""
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
    """A watch that says yes when the force differs from `rest` by more than `limit` N.

    vertical: only the upward change counts. None when nothing can be felt.
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
        Failure: GRIPPER_STUCK when the fingers do not get there.
    """
    reached = yield from move_gripper(robot, clock, width, force, timeout, "opening")
    if reached < width - 2 * OPEN_TOLERANCE:
        raise Failure(
            "GRIPPER_STUCK",
            f"the gripper opened to {reached * 1000:.0f} mm of {width * 1000:.0f} mm",
            reached=reached,
            asked=width,
        )

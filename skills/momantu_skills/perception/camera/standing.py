"""Waiting until the whole robot stands, so that a picture belongs to one posture."""

from __future__ import annotations

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.messages import RobotState
from momantu_bt.robot import Robot
from momantu_bt.skill import Run

STILL = 0.01
"""A joint or the base stands if it moves more slowly, rad/s or m/s."""
STANDING = 0.3
"""How long all must stand before the picture is taken, s."""
PATIENCE = 5.0
"""How long to wait for that, s."""


def until_standing(robot: Robot) -> Run:
    """Wait until joints and base stand; raises Failure STILL_MOVING if they do not in time."""
    begun = rested = robot.state().stamp
    while (now := robot.state()).stamp - rested < STANDING:
        if _moves(now):
            rested = now.stamp
        if now.stamp - begun > PATIENCE:
            raise Failure("STILL_MOVING", f"the robot still moves after {PATIENCE:g} s")
        yield "waiting"


def _moves(state: RobotState) -> bool:
    speeds = np.abs([*state.velocities, state.linear, state.angular])
    return bool(speeds.max() > STILL)

"""Going back from where an arm met something, along the way that it came."""

from __future__ import annotations

from collections.abc import Callable, Generator

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.geometry import Array
from momantu_bt.messages import JointTrajectory
from momantu_bt.robot import Robot
from momantu_bt.skill import Clock
from momantu_skills.manipulation.motion.following import CODE, STILL, follow, joints_of

BACK = 0.12
"""How far the joints go back, rad or m: the hand of an outstretched arm goes about 10 cm."""
AHEAD = 0.1
"""How far ahead on the way the joints would have been in what they met, rad or m."""


def way_back(trajectory: JointTrajectory, here: Array) -> Array:
    """Joints (k, n) from `here` back along a trajectory, at most `BACK`."""
    path = trajectory.positions[_nearest(trajectory, here) :: -1]
    off = np.abs(path - here).max(axis=1)
    end = int(np.argmax(off > BACK)) if (off > BACK).any() else len(path) - 1
    return np.vstack([here, path[: end + 1]])


def way_ahead(trajectory: JointTrajectory, here: Array) -> Array:
    """Joints (n,) where the arm would have been a little later than `here`."""
    rest = trajectory.positions[_nearest(trajectory, here) :]
    off = np.abs(rest - here).max(axis=1)
    return np.asarray(rest[int(np.argmax(off > AHEAD))] if (off > AHEAD).any() else rest[-1])


def recoil(
    robot: Robot,
    clock: Clock,
    actuator: str,
    trajectory: JointTrajectory,
    timed: Callable[[Array], JointTrajectory],
) -> Generator[str, None, bool]:
    """Go back from where an arm is stuck on a trajectory; whether it moved.

    timed: makes a slow trajectory of joints (k, n). An arm that does not move at all was not
    stopped by something in its way: its driver does not answer.
    """
    here = joints_of(robot, trajectory.names)
    path = way_back(trajectory, here)
    if float(np.abs(path - here).max()) < STILL:
        return False
    try:
        yield from follow(robot, clock, actuator, timed(path), "going back")
    except Failure as failure:
        if failure.code != CODE:
            raise
    moved = float(np.abs(joints_of(robot, trajectory.names) - here).max())
    return moved > 2 * STILL


def _nearest(trajectory: JointTrajectory, here: Array) -> int:
    return int(np.argmin(np.abs(trajectory.positions - here).max(axis=1)))

"""What perception needs: a camera before painted solids, and a scene that masks the robot."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from momantu_bt.detector import View
from momantu_bt.messages import (
    RobotState,
)
from momantu_bt.service import HeldObject, Snapshot
from momantu_bt.testing import (
    ScriptedRobot,
)

Box3 = tuple[tuple[float, float, float], tuple[float, float, float]]
Onlooker = Callable[..., ScriptedRobot]
Viewed = Callable[..., list[View]]


class SeenScene:
    """A planning scene to which points in a box (low, high corners in the base) are the robot.

    observed: how many pictures it was shown.
    """

    last_contact = -math.inf

    def __init__(self, held: HeldObject | None = None, robot: Sequence[Box3] = ()) -> None:
        self.held, self.robot = held, robot
        self.observed = 0
        self.low_things = np.empty((0, 2))

    def observe(self, snapshot: Snapshot) -> None:
        self.observed += 1

    def is_robot(self, points: np.ndarray, state: RobotState) -> np.ndarray:
        inside = np.zeros(len(points), dtype=bool)
        for low, high in self.robot:
            inside |= ((points >= low) & (points <= high)).all(axis=1)
        return inside

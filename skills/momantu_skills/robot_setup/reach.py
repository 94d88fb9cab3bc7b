"""Where a robot's hand reaches, and from how many sides: random postures in batches."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from momantu_bt.errors import InputError
from momantu_bt.geometry import Array
from momantu_bt.robot import ARM, RobotDescription
from momantu_skills.manipulation.model.batched import BatchedChain

CELL = 0.1
"""Edge of a cell, m."""
_BATCH = 20_000
_SIDES = np.array(
    [
        (x, y, z)
        for x in (-1, 0, 1)
        for y in (-1, 0, 1)
        for z in (-1, 0, 1)
        if abs(x) + abs(y) + abs(z) in (1, 3)
    ],
    dtype=np.float64,
)
SIDES = _SIDES / np.linalg.norm(_SIDES, axis=1)[:, None]
"""(14, 3): directions in which the hand may point, to the faces and corners of a cube."""


@dataclass(frozen=True, slots=True, eq=False)
class Reach:
    """Cells of CELL m in the base's frame, from `low` (3,) on.

    sides: (nx, ny, nz) share of the 14 directions in which the hand points there in some posture;
    above 0 where it reaches. The hand's point is the origin of its grasp frame.
    """

    low: Array
    sides: Array
    postures: int

    def band(self, bottom: float, top: float) -> Array:
        """From above: the best share (nx, ny) of all cells between two heights, m."""
        first, last = (math.floor((z - self.low[2]) / CELL) for z in (bottom, top))
        count = self.sides.shape[2]
        first, last = max(0, first), min(count - 1, last)
        if first > last:
            return np.zeros(self.sides.shape[:2])
        return np.asarray(self.sides[:, :, first : last + 1].max(2))

    def side(self) -> Array:
        """From the right side: the best share (nx, nz) over all y."""
        return np.asarray(self.sides.max(1))

    def middles(self) -> Array:
        """Middles (n, 3) of the cells that are reached, m."""
        return np.asarray(self.low + (np.argwhere(self.sides > 0) + 0.5) * CELL)


def reach(robot: RobotDescription, postures: int, seed: int) -> Reach:
    """Try random postures of the arm within its limits; those with the hand in the floor are out.

    The arm's own collisions are not checked.

    Raises:
        InputError: the robot has no arm or no hand.
    """
    if not robot.has_arm or robot.end_effector is None:
        having = ", ".join(robot.actuators) or "none"
        raise InputError(f"the robot {robot.name} has no arm with a hand; actuators: {having}")
    points, pointing = _points(robot, postures, np.random.default_rng(seed))
    low = np.floor(points.min(0) / CELL) * CELL
    cells = np.floor((points - low) / CELL + 1e-9).astype(int)
    seen = np.zeros((*(cells.max(0) + 1), len(SIDES)), dtype=bool)
    seen[(*cells.T, (pointing @ SIDES.T).argmax(1))] = True
    return Reach(low, seen.mean(3), postures)


def _points(
    robot: RobotDescription, postures: int, random: np.random.Generator
) -> tuple[Array, Array]:
    """Where the hand is (n, 3), m, and where it points (n, 3), above the floor."""
    chain = BatchedChain(robot, robot.hand.frame)
    moving = set(robot.groups[ARM].joints)
    limits = [robot.joint_limits.get(name) if name in moving else None for name in chain.names]
    low = np.array([_end(None if e is None else e.lower, -1, e is None) for e in limits])
    high = np.array([_end(None if e is None else e.upper, 1, e is None) for e in limits])
    points, pointing = [], []
    for first in range(0, postures, _BATCH):
        count = min(_BATCH, postures - first)
        poses = chain.matrices(random.uniform(low, high, (count, len(low))))
        ahead = poses[:, :3, 0]
        place = poses[:, :3, 3] + robot.hand.grasp_offset * ahead
        free = place[:, 2] > 0.0
        points.append(place[free])
        pointing.append(ahead[free])
    return np.concatenate(points), np.concatenate(pointing)


def _end(limit: float | None, sign: int, still: bool) -> float:
    """One limit of a joint: pi if it turns without end, 0 of a joint that is not the arm's."""
    if still:
        return 0.0
    return sign * math.pi if limit is None else limit

"""How far from its base an arm reaches objects on tables."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_skills.robot_setup.find.base import Stand
from momantu_skills.robot_setup.urdf.arm_ik import LimbSolver

HEIGHTS = (0.4, 0.5, 0.6, 0.7, 0.8)
"""Heights of the tables, m."""
ABOVE = 0.06
"""Height of a grasp above the table, m."""
STEP = 0.05
"""Step between distances that are tried, m."""
FARTHEST = 1.6
"""Largest distance, m; no arm on a mobile base reaches farther."""
YAWS = (-1.0, -0.5, 0.0, 0.5, 1.0)
"""Yaw angles of the hand in a level grasp, rad."""
PITCHES = (0.0, math.pi / 4, math.pi / 2)
"""Downward angles of the hand, rad."""
SEEDS = 8
"""Start postures of the inverse kinematics per pose."""
GOOD = 0.8
"""Share of the heights that must be reached for a distance to count."""
SIDES = {"to its right": -math.pi / 2, "to its left": math.pi / 2, "behind it": math.pi}
"""Directions in which an arm may reach that does not reach ahead, rad."""
ROOM = 0.13
"""Distance between the footprint and a table's edge, m."""
BESIDE = 0.08
"""Least distance of objects from a table's edge, m."""
LOOK_BACK = 0.18
"""Additional distance of the robot for looking, m."""


@dataclass(frozen=True)
class Reach:
    """shares: (k,) of grasps that are reached at distances (k,) from the base, m.

    stand_off, look_off, reach: see `Working`. measured: whether the arm reached anything.
    """

    distances: Array
    shares: Array
    stand_off: float
    look_off: float
    reach: tuple[float, float, float]
    measured: bool
    aside: str = ""
    """Where the hand reaches such grasps instead, if it reaches none ahead; empty: nowhere."""
    freedoms: int = 6
    """In how many of its six directions and turns the arm moves the hand."""


def find_reach(solver: LimbSolver | None, stand: Stand) -> Reach:
    """Sample grasps before the robot at the heights of tables."""
    distances = np.arange(STEP, FARTHEST + STEP / 2, STEP)
    shares, heights = np.zeros(len(distances)), np.zeros(len(distances))
    if solver is not None:
        shares, heights = reached(solver, distances, stand.floor)
    stand_off = math.ceil((stand.front + ROOM) * 100) / 100
    least = stand_off + BESIDE
    good = np.flatnonzero((heights >= GOOD) & (distances >= least - 1e-9))
    if not len(good):
        fallback = (least, least + 0.2, least + 0.4)
        aside = "" if solver is None else _aside(solver, distances, stand.floor)
        freedoms = 0 if solver is None else _freedoms(solver)
        off = stand_off + LOOK_BACK
        return Reach(distances, shares, stand_off, off, _cm(fallback), False, aside, freedoms)
    near, far = float(distances[good[0]]), float(distances[good[-1]])
    strong = good[shares[good] >= 0.8 * shares[good].max()]
    best = float(distances[strong].mean())
    return Reach(
        distances, shares, stand_off, round(stand_off + LOOK_BACK, 2), _cm((near, best, far)), True
    )


def _freedoms(solver: LimbSolver) -> int:
    """The largest rank of the hand's Jacobian in some postures."""
    ranks = [
        np.linalg.matrix_rank(solver.group.jacobian(q), tol=1e-4) for q in solver.starts(SEEDS)
    ]
    return int(max(ranks))


def _aside(solver: LimbSolver, distances: Array, floor: float) -> str:
    """The side on which the hand reaches grasps on most heights of tables; empty if none."""
    for side, turned in SIDES.items():
        _, heights = reached(solver, distances, floor, turned)
        if heights.max() >= GOOD:
            return side
    return ""


def reached(
    solver: LimbSolver, distances: Array, floor: float, turned: float = 0.0
) -> tuple[Array, Array]:
    """What is reached at distances (k,), m, straight ahead or in a direction `turned` rad from it.

    Returns the share of grasps (k,), and the share of the tables' heights with one of them (k,).
    """
    turn = Transform.from_rpy((0.0, 0.0, 0.0), (0.0, 0.0, turned)).matrix
    targets = np.array([turn @ _poses(distance, floor) for distance in distances])
    flat = solver.reaches(targets.reshape(-1, 4, 4), SEEDS)
    good = flat.reshape(len(distances), len(HEIGHTS), -1)
    return good.mean(axis=(1, 2)), good.any(axis=2).mean(axis=1)


def _cm(values: tuple[float, float, float]) -> tuple[float, float, float]:
    a, b, c = (round(v, 2) for v in values)
    return a, b, c


def _poses(distance: float, floor: float) -> Array:
    """base_from_grasp (heights, ways, 4, 4) straight ahead: level from five sides, or pitched."""
    ways = [(0.0, yaw) for yaw in YAWS] + [(pitch, 0.0) for pitch in PITCHES[1:]]
    return np.array(
        [
            [
                Transform.from_rpy(
                    (distance, 0.0, floor + height + ABOVE), (0.0, pitch, yaw)
                ).matrix
                for pitch, yaw in ways
            ]
            for height in HEIGHTS
        ]
    )

"""How far from its base an arm reaches objects on tables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Transform
from momantu_bt.robot import Working
from momantu_skills.manipulation.arm import SWING
from momantu_skills.manipulation.config import HandConfig
from momantu_skills.robot_setup.find.base import Stand
from momantu_skills.robot_setup.urdf.arm_ik import LimbSolver

HEIGHTS = (0.4, 0.5, 0.6, 0.7, 0.8)
"""Heights of the usual tables, m."""
LADDER = tuple(round(0.1 * k, 1) for k in range(1, 13))
"""Heights that are tried where the arm reaches no usual table, m."""
FEWEST = 2
"""Least number of neighbouring heights of the ladder that are taken for the tables of an arm."""
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
HEADINGS = (0.0, -math.pi / 2, math.pi / 2, math.pi)
"""Directions in which an arm may reach, rad."""
LATERALS = tuple(round(0.03 * k, 2) for k in range(-8, 9))
"""Offsets of the line of reach from the base's middle that are tried, m to the left."""
BREADTHS = (0.01, 0.02, 0.03, 0.05, 0.07, 0.1)
"""Offsets from the line of reach that are tried, m."""
ROOM = 0.13
"""Distance between the footprint and a table's edge, m."""
BESIDE = 0.08
"""Least distance of objects from a table's edge, m."""
APPROACH = HandConfig().approach
"""How far behind a grasp the hand begins and ends, m."""
TURN = SWING
"""How far an arm with few joints may turn its hand from its line of reach on that way, rad."""
LONG = 0.1
"""Least difference of nearest and farthest distance, m, at which a reach is taken."""
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
    heading: float = 0.0
    """Direction in which the arm reaches, rad from straight ahead."""
    lateral: float = 0.0
    """How far to the left of the base's middle its line of reach lies, m."""
    breadth: float | None = None
    """How far beside that line an arm with few joints reaches, m; None: of other arms."""
    freedoms: int = 6
    """In how many of its six directions and turns the arm moves the hand."""
    tables: tuple[float, ...] = HEIGHTS
    """Heights of the tables that were tried, m: other ones where no usual one is reached."""


def find_reach(solver: LimbSolver | None, stand: Stand) -> Reach:
    """Sample grasps before the robot at the heights of tables: of usual ones, or of others."""
    distances = np.arange(STEP, FARTHEST + STEP / 2, STEP)
    if solver is not None:
        found = _found(solver, distances, stand, HEIGHTS)
        if found is None and (others := _others(solver, distances, stand)):
            found = _found(solver, distances, stand, others)
        if found is not None:
            return found
    stand_off = _stand_off(stand, 0.0)
    least = stand_off + BESIDE
    return Reach(
        distances,
        np.zeros(len(distances)),
        stand_off,
        round(stand_off + LOOK_BACK, 2),
        _cm((least, least + 0.2, least + 0.4)),
        False,
        freedoms=0 if solver is None else solver.group.freedoms,
    )


def _found(
    solver: LimbSolver, distances: Array, stand: Stand, tables: tuple[float, ...]
) -> Reach | None:
    """The reach over tables of some heights: ahead, else along another line; None without any."""
    shares, heights = reached(solver, distances, stand.floor, tables=tables)
    stand_off = _stand_off(stand, 0.0)
    good = _useful(heights, distances, stand_off)
    if solver.group.few or not len(good):
        aside = _beside(solver, distances, stand, tables)
        if aside is not None:
            return aside
    if not len(good):
        return None
    span, look_off = _span(distances, shares, good), round(stand_off + LOOK_BACK, 2)
    return Reach(distances, shares, stand_off, look_off, span, True, tables=tables)


def _others(solver: LimbSolver, distances: Array, stand: Stand) -> tuple[float, ...]:
    """Neighbouring heights, m, at which the arm reaches tables straight ahead; most of them.

    Of runs as long as each other the one that is reached from more distances counts.
    """
    far = distances[distances >= _stand_off(stand, 0.0) + BESIDE - 1e-9]
    counts = [reached(solver, far, stand.floor, tables=(z,))[1].sum() for z in LADDER]
    best: tuple[int, ...] = ()
    for low in range(len(LADDER)):
        run = list(takewhile(lambda k: counts[k] > 0, range(low, len(LADDER))))
        if (len(run), sum(counts[k] for k in run)) > (len(best), sum(counts[k] for k in best)):
            best = tuple(run)
    return tuple(LADDER[k] for k in best) if len(best) >= FEWEST else ()


def _stand_off(stand: Stand, heading: float) -> float:
    """Least distance to a table's edge in a direction, m."""
    front = stand.front
    if heading and stand.footprint is not None:
        front = float((stand.footprint @ (math.cos(heading), math.sin(heading))).max())
    return math.ceil((front + ROOM) * 100) / 100


def _useful(heights: Array, distances: Array, stand_off: float) -> NDArray[np.int64]:
    """Indices of the distances at which objects on tables of nearly every height are reached."""
    return np.asarray(np.flatnonzero((heights >= GOOD) & (distances >= stand_off + BESIDE - 1e-9)))


def _span(distances: Array, shares: Array, good: NDArray[np.int64]) -> tuple[float, float, float]:
    """Nearest, best and farthest of the good distances, m."""
    near, far = float(distances[good[0]]), float(distances[good[-1]])
    strong = good[shares[good] >= 0.8 * shares[good].max()]
    best = float(distances[strong].mean())
    return _cm((near, best, far))


def _beside(
    solver: LimbSolver, distances: Array, stand: Stand, tables: tuple[float, ...]
) -> Reach | None:
    """The line of reach of an arm that reaches nothing straight ahead of the base's middle."""
    best: tuple[float, float, float] | None = None
    for heading in HEADINGS:
        for lateral in LATERALS:
            line = (heading, lateral, tables)
            shares, heights = reached(solver, distances[1::3], stand.floor, *line)
            good = _useful(heights, distances[1::3], _stand_off(stand, heading))
            worth = float(shares[good].sum())
            if worth > (best[0] if best else 0.0):
                best = (worth, heading, lateral)
    if best is None:
        return None
    _, heading, lateral = best
    line = (heading, lateral, tables)
    shares, heights = reached(solver, distances, stand.floor, *line)
    stand_off = _stand_off(stand, heading)
    good = _useful(heights, distances, stand_off)
    if not len(good):
        return None
    if solver.group.few:
        straight = _straight(solver, distances, stand.floor, *line)
        led = _useful(straight, distances, stand_off)
        if len(led) and distances[led[-1]] - distances[led[0]] > LONG:
            shares, good = straight, led
    span = _span(distances, shares, good)
    return Reach(
        distances,
        shares,
        stand_off,
        round(stand_off + LOOK_BACK, 2),
        span,
        True,
        heading,
        lateral,
        _breadth(solver, span[1], stand.floor, *line) if solver.group.few else None,
        solver.group.freedoms,
        tables,
    )


def _straight(
    solver: LimbSolver,
    distances: Array,
    floor: float,
    heading: float,
    lateral: float,
    tables: tuple[float, ...],
) -> Array:
    """Share (k,) of the tables' heights at which an arm with few joints comes and goes level.

    A telescope that grasps as near as it can has no room to go back, and a hand that it turned
    aside instead meets the arm. What such an arm carries upright it grasped level.
    """
    turn = _line(heading, lateral)
    targets = np.array(
        [turn @ _poses(distance, floor, (0.0,), (), tables) for distance in distances]
    )
    flat = targets.reshape(-1, 4, 4)
    behind = flat @ Transform((-APPROACH, 0.0, 0.0)).matrix
    good = np.logical_and(*(solver.reaches(poses, SEEDS, TURN) for poses in (flat, behind)))
    return np.asarray(good.reshape(len(distances), len(tables)).mean(axis=1))


def _line(heading: float, lateral: float) -> Array:
    """base_from_reach (4, 4): x along the line of reach."""
    line = Working(stand_off=1.0, look_off=1.0, heading=heading, lateral=lateral).base_from_reach
    return Transform.from_rpy((line.x, line.y, 0.0), (0.0, 0.0, line.yaw)).matrix


def _breadth(
    solver: LimbSolver,
    distance: float,
    floor: float,
    heading: float,
    lateral: float,
    tables: tuple[float, ...],
) -> float:
    """How far to either side of its line the arm reaches tables at the best distance, m."""
    far = 0.0
    for offset in BREADTHS:
        sides = (lateral - offset, lateral + offset)
        at = np.array([distance])
        heights = [reached(solver, at, floor, heading, y, tables)[1][0] for y in sides]
        if min(heights) < GOOD:
            break
        far = offset
    return far


def reached(
    solver: LimbSolver,
    distances: Array,
    floor: float,
    heading: float = 0.0,
    lateral: float = 0.0,
    tables: tuple[float, ...] = HEIGHTS,
) -> tuple[Array, Array]:
    """What is reached at distances (k,), m, straight ahead, or along another line of reach.

    heading: of the line, rad. lateral: how far to the left of the base's middle it lies, m. tables:
    their heights, m.

    Returns the share of grasps (k,), and the share of the tables' heights with one of them (k,).
    """
    turn = _line(heading, lateral)
    yaws = (0.0,) if solver.group.few else YAWS
    ways = (floor, yaws, PITCHES[1:], tables)
    targets = np.array([turn @ _poses(distance, *ways) for distance in distances])
    flat = solver.reaches(targets.reshape(-1, 4, 4), SEEDS)
    good = flat.reshape(len(distances), len(tables), -1)
    return good.mean(axis=(1, 2)), good.any(axis=2).mean(axis=1)


def _cm(values: tuple[float, float, float]) -> tuple[float, float, float]:
    a, b, c = (round(v, 2) for v in values)
    return a, b, c


def _poses(
    distance: float,
    floor: float,
    yaws: Sequence[float],
    pitches: Sequence[float],
    tables: tuple[float, ...],
) -> Array:
    """base_from_grasp (heights, ways, 4, 4) straight ahead: level at some yaws, or pitched."""
    ways = [(0.0, yaw) for yaw in yaws] + [(pitch, 0.0) for pitch in pitches]
    return np.array(
        [
            [
                Transform.from_rpy(
                    (distance, 0.0, floor + height + ABOVE), (0.0, pitch, yaw)
                ).matrix
                for pitch, yaw in ways
            ]
            for height in tables
        ]
    )

"""Points of a submap with the lines through them, and a scan laid onto them.

The distance of a point to a line is what counts, as in Censi, An ICP variant using a point-to-line
metric, ICRA 2008. A point stays where it was entered, so that the walls of a submap stay thin.
"""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array

ROUNDS = 15
"""Most rounds of matching and moving."""
SAME_SIDE = 0.7
"""Least cosine between the normals of a point and of the line that it is laid on."""
ROBUST = 0.05
"""Distance from which on a point counts for less, m (Cauchy's weight)."""
NOISE = 0.03
"""Standard deviation of a point's distance to its line, m."""
ALIKE = 5.0
"""How many points in a row share their errors, so that they count as one."""
FEWEST = 12
"""Fewest points that say anything."""


@numba.njit(cache=True)
def add_lines(
    index: NDArray[np.int32],
    count: int,
    points: Array,
    normals: Array,
    corner: Array,
    cell: float,
    new_points: Array,
    new_normals: Array,
) -> int:
    """Enter points (n, 2) with normals into cells that have none; returns the new count.

    index: of each cell's point, or -1. points, normals: (capacity, 2).
    """
    rows, columns = index.shape
    for i in range(new_points.shape[0]):
        if new_normals[i, 0] == 0.0 and new_normals[i, 1] == 0.0:
            continue
        c = math.floor((new_points[i, 0] - corner[0]) / cell)
        r = math.floor((new_points[i, 1] - corner[1]) / cell)
        if c < 0 or r < 0 or c >= columns or r >= rows or count >= points.shape[0]:
            continue
        if index[r, c] < 0:
            index[r, c] = count
            points[count] = new_points[i]
            normals[count] = new_normals[i]
            count += 1
    return count


@numba.njit(cache=True)
def _nearest(
    index: NDArray[np.int32],
    points: Array,
    normals: Array,
    corner: Array,
    cell: float,
    at: Array,
    normal: Array,
    gate: float,
) -> int:
    """The nearest point within `gate` m whose line faces the same side, or -1."""
    rows, columns = index.shape
    c = math.floor((at[0] - corner[0]) / cell)
    r = math.floor((at[1] - corner[1]) / cell)
    reach = math.ceil(gate / cell)
    faced = normal[0] != 0.0 or normal[1] != 0.0
    best = gate * gate
    found = -1
    for row in range(max(0, r - reach), min(rows, r + reach + 1)):
        for column in range(max(0, c - reach), min(columns, c + reach + 1)):
            j = index[row, column]
            if j < 0:
                continue
            if faced and normal[0] * normals[j, 0] + normal[1] * normals[j, 1] < SAME_SIDE:
                continue
            far = (at[0] - points[j, 0]) ** 2 + (at[1] - points[j, 1]) ** 2
            if far < best:
                best = far
                found = j
    return found


@numba.njit(cache=True)
def _pulled(
    index: NDArray[np.int32],
    points: Array,
    normals: Array,
    corner: Array,
    cell: float,
    scan: Array,
    scan_normals: Array,
    pose: Array,
    gate: float,
    information: Array,
    pull: Array,
) -> tuple[float, int]:
    """Sum one round's equations into `information` (3, 3) and `pull` (3,), for variances of 1.

    Returns the weighted sum of the squared distances, m^2, and how many points have a line.
    """
    information[:] = 0.0
    pull[:] = 0.0
    squares, count = 0.0, 0
    at, normal, slope = np.empty(2), np.empty(2), np.empty(3)
    c, s = math.cos(pose[2]), math.sin(pose[2])
    for i in range(scan.shape[0]):
        dx, dy = c * scan[i, 0] - s * scan[i, 1], s * scan[i, 0] + c * scan[i, 1]
        at[0], at[1] = pose[0] + dx, pose[1] + dy
        normal[0] = c * scan_normals[i, 0] - s * scan_normals[i, 1]
        normal[1] = s * scan_normals[i, 0] + c * scan_normals[i, 1]
        j = _nearest(index, points, normals, corner, cell, at, normal, gate)
        if j < 0:
            continue
        nx, ny = normals[j, 0], normals[j, 1]
        off = (at[0] - points[j, 0]) * nx + (at[1] - points[j, 1]) * ny
        slope[0], slope[1], slope[2] = nx, ny, dx * ny - dy * nx
        weight = 1.0 / (1.0 + (off / ROBUST) ** 2)
        for a in range(3):
            pull[a] -= weight * slope[a] * off
            for b in range(3):
                information[a, b] += weight * slope[a] * slope[b]
        squares += weight * off * off
        count += 1
    return squares, count


@numba.njit(cache=True)
def lay_on(
    index: NDArray[np.int32],
    points: Array,
    normals: Array,
    corner: Array,
    cell: float,
    scan: Array,
    scan_normals: Array,
    start: Array,
    expected: Array,
    deviation: Array,
    doubt: float,
    gate: float,
) -> tuple[Array, Array, float, int]:
    """Move a scan (n, 2) from a start pose (3,) onto the lines; point to line, Gauss-Newton.

    expected, deviation: a pose (3,) that is believed with standard deviations (m, rad). doubt: how
    many times larger than usual the variance of a match is. gate: distance of points that belong
    together at the end, m; three times as much in the first round.

    Returns the pose (3,), the information (3, 3) that the points give about it, in the frame of the
    submap, the root mean square of their distances in m, and how many there are.
    """
    pose = start.copy()
    information = np.zeros((3, 3))
    pull = np.zeros(3)
    weight_of_one = 1.0 / (NOISE**2 * ALIKE * doubt)
    prior = np.array([deviation[0] ** -2.0, deviation[0] ** -2.0, deviation[1] ** -2.0])
    misfit, count = 1.0, 0
    for turn in range(ROUNDS):
        within = gate * max(1.0, 3.0 - 0.5 * turn)
        squares, count = _pulled(
            index,
            points,
            normals,
            corner,
            cell,
            scan,
            scan_normals,
            pose,
            within,
            information,
            pull,
        )
        if count < FEWEST:
            return pose, np.zeros((3, 3)), 1.0, count
        misfit = math.sqrt(squares / count)
        information *= weight_of_one
        pull *= weight_of_one
        system = information.copy()
        for a in range(3):
            system[a, a] += prior[a]
            pull[a] -= prior[a] * (pose[a] - expected[a])
        move = np.linalg.solve(system, pull)
        pose += move
        if turn > 3 and abs(move[0]) + abs(move[1]) < 2e-4 and abs(move[2]) < 2e-4:
            break
    return pose, information, misfit, count

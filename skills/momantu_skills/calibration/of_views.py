"""Both trajectories of a hand-eye calibration, from a file of views that record_view wrote."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.calibration.errors import CalibrationError
from momantu_skills.calibration.robot.rows import read_rows
from momantu_skills.calibration.trajectory.trajectory import Trajectory


def trajectories(file: Path) -> tuple[Trajectory, Trajectory]:
    """base_from_hand and camera_from_target of the views that have both.

    Raises:
        CalibrationError: the file is wrong, or no view has both poses.
    """
    rows = [row for row in read_rows(file) if row.hand is not None and row.target is not None]
    if not rows:
        raise CalibrationError(
            f"{file} has no view with the poses of hand and target; record_view writes them where "
            "it has a `target`, a tag or bundle of the site"
        )
    times = np.array([row.stamp for row in rows])
    lines = np.array([row.line for row in rows], dtype=np.intp)
    hands = np.array([row.hand for row in rows], dtype=float)
    targets = np.array([row.target for row in rows], dtype=float)
    return (
        _trajectory(f"{file} (hand)", times, hands, lines),
        _trajectory(f"{file} (target)", times, targets, lines),
    )


def _trajectory(name: str, times: Array, poses: Array, lines: np.ndarray) -> Trajectory:
    quaternions = poses[:, [6, 3, 4, 5]]
    lengths = np.linalg.norm(quaternions, axis=1)
    wrong = np.flatnonzero(np.abs(lengths - 1.0) > 0.05)
    if len(wrong):
        raise CalibrationError(
            f"{name}, line {lines[wrong[0]]}: the quaternion has the length "
            f"{lengths[wrong[0]]:.3g}; expected 1"
        )
    return Trajectory(name, times, poses[:, :3], quaternions / lengths[:, None], lines)

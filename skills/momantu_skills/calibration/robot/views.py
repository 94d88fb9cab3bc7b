"""The views of a robot as arrays: which tag each picture saw, from which posture and stand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, wrap_angle
from momantu_bt.robot import RobotDescription
from momantu_skills.calibration.errors import CalibrationError
from momantu_skills.calibration.robot.rows import Row
from momantu_skills.manipulation.model.batched import BatchedChain

_STOOD = (0.0005, 0.001)
"""m and rad: odometry that changes by less is that of one stand."""
_FEWEST = 8
"""Views below which nothing is estimated."""
_LEAST_TURN = np.radians(3.0)
"""The joint that moved most must have moved by more, else all views are alike; rad (m: a tenth)."""
_LEAST_WAY = 0.1
"""m; a base that drove less tells nothing about its wheels."""


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """Measured steps (k, 3) from one stand to the next: x, y in m and yaw in rad of each step."""

    steps: Array


@dataclass(frozen=True, slots=True, eq=False)
class Views:
    """N sightings of tags.

    positions: (N, J) of `joints`; corners: (N, 4, 2) px; models: (N, 4, 3) m, the same corners on
    the tag; intrinsics: (N, 4). tags, stands: (N,) indices into `tag_ids` and the stands.
    lines: (N,) of the file. drives: between stand i and i + 1.
    """

    joints: tuple[str, ...]
    camera: str
    positions: Array
    corners: Array
    models: Array
    intrinsics: Array
    tag_ids: tuple[int, ...]
    tags: NDArray[np.intp]
    stands: NDArray[np.intp]
    lines: NDArray[np.intp]
    drives: tuple[Drive, ...]
    stand_poses: Array
    """(stands, 3): x, y, yaw of odometry."""

    def __len__(self) -> int:
        return len(self.tags)

    def chosen(self, mask: NDArray[np.bool_] | NDArray[np.intp]) -> Views:
        """Some of the sightings; tags and stands keep their indices."""
        return Views(
            self.joints,
            self.camera,
            self.positions[mask],
            self.corners[mask],
            self.models[mask],
            self.intrinsics[mask],
            self.tag_ids,
            self.tags[mask],
            self.stands[mask],
            self.lines[mask],
            self.drives,
            self.stand_poses,
        )


_UNIT = np.array([[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]])


def gather(
    rows: Sequence[Row], description: RobotDescription, chains: Sequence[BatchedChain], camera: str
) -> Views:
    """The views of one camera of a robot.

    Tags that only one picture shows tell nothing and are left out.

    Raises:
        CalibrationError: a joint is missing, there are too few views, or all are alike.
    """
    joints = tuple(dict.fromkeys(name for chain in chains for name in chain.names))
    stands, poses, drives = _stands(rows)
    seen = [
        (row, stand, tag)
        for row, stand in zip(rows, stands, strict=True)
        if row.camera in (None, camera)
        for tag in row.tags
    ]
    counts = np.unique([tag.tag_id for _, _, tag in seen], return_counts=True)
    ids = tuple(int(i) for i, count in zip(*counts, strict=True) if count >= 2)
    seen = [each for each in seen if each[2].tag_id in ids]
    views = len({row.line for row, _, _ in seen})
    if views < _FEWEST:
        cameras = {row.camera for row in rows if row.tags and row.camera is not None}
        other = f"; the file has views of: {', '.join(sorted(cameras))}" if cameras else ""
        raise CalibrationError(
            f"{views} views of the camera {camera} show a tag that another shows too; "
            f"{_FEWEST} or more are needed, and 30 are good{other}"
        )
    positions = np.array([_positions(row, joints, description) for row, _, _ in seen])
    found = Views(
        joints,
        camera,
        positions,
        np.array([tag.corners for _, _, tag in seen]),
        np.array([_UNIT * tag.edge for _, _, tag in seen]),
        np.array([row.intrinsics for row, _, _ in seen]),
        ids,
        np.array([ids.index(tag.tag_id) for _, _, tag in seen]),
        np.array([stand for _, stand, _ in seen]),
        np.array([row.line for row, _, _ in seen]),
        tuple(drives),
        np.array(poses),
    )
    _refuse_alike(found)
    return found


def _positions(row: Row, joints: Sequence[str], description: RobotDescription) -> list[float]:
    commanded = {name for each in description.actuators.values() for name in each.joints}
    missing = [name for name in joints if name in commanded and name not in row.joints]
    if missing:
        raise CalibrationError(
            f"line {row.line}: the position of {missing[0]} is missing, which moves the camera or "
            f"the hand of {description.name}; the line has: {', '.join(row.joints) or 'none'}"
        )
    return [row.joints.get(name, 0.0) for name in joints]


def _stands(rows: Sequence[Row]) -> tuple[list[int], list[Array], list[Drive]]:
    """The stand of each row, the odometry at each stand, and what was driven between them.

    A row without tags is a step on the way.
    """
    stands: list[int] = []
    poses: list[Array] = []
    drives: list[Drive] = []
    steps: list[Array] = []
    last: Array | None = None
    for row in rows:
        here = row.odometry
        if last is not None and here is not None:
            step = _relative(last, here)
            if np.hypot(*step[:2]) > _STOOD[0] or abs(step[2]) > _STOOD[1]:
                steps.append(step)
                last = here
        elif here is not None:
            last = here
        if row.tags and (steps or not poses):
            if poses:
                drives.append(Drive(np.array(steps)))
            poses.append(np.zeros(3) if last is None else last)
            steps = []
        stands.append(max(0, len(poses) - 1))
    return stands, poses or [np.zeros(3)], drives


def _relative(start: Array, end: Array) -> Array:
    c, s = np.cos(start[2]), np.sin(start[2])
    x, y = end[:2] - start[:2]
    return np.array([c * x + s * y, c * y - s * x, wrap_angle(float(end[2] - start[2]))])


def _refuse_alike(views: Views) -> None:
    moved = np.ptp(views.positions, axis=0)
    driven = sum(float(np.hypot(*d.steps[:, :2].T).sum()) for d in views.drives)
    turned = sum(float(np.abs(d.steps[:, 2]).sum()) for d in views.drives)
    still = moved.max(initial=0.0) < _LEAST_TURN
    if still and driven < _LEAST_WAY and turned < _LEAST_TURN:
        raise CalibrationError(
            f"all views are alike: no joint moves by more than {np.degrees(moved.max()):.1f} "
            "degrees and the base does not drive; turn head and arm by 20 degrees and more between "
            "views"
        )

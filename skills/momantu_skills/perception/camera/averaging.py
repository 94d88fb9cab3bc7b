"""Several pictures from one place, to be averaged where it is dark."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import numpy as np

from momantu_bt.frames import FrameBuffer
from momantu_bt.geometry import Transform
from momantu_bt.robot import Robot
from momantu_bt.service import Snapshot
from momantu_bt.skill import Compute
from momantu_skills.perception.camera.snapshot import take

HELD = (0.002, 0.002)
"""Largest movement of the camera between pictures that are averaged, m and rad: about a pixel."""


def still_pictures(
    robot: Robot, frames: FrameBuffer, first: Snapshot, count: int
) -> Generator[str | Compute, Any, list[Snapshot]]:
    """Take pictures, one a tick, until there are `count` from one place, the first one included.

    Raises:
        Failure: SENSOR_DEAD.
    """
    pictures = [first]
    while len(pictures) < count:
        yield f"averages {count} dark pictures"
        pictures.append(take(robot, frames))
        if not _still(pictures[0].odom_from_camera, pictures[-1].odom_from_camera):
            pictures = pictures[-1:]
    return pictures


def _still(one: Transform, other: Transform) -> bool:
    shift = float(np.linalg.norm(one.position - other.position))
    return shift <= HELD[0] and one.angle_to(other) <= HELD[1]

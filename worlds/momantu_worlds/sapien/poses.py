"""Converting between SAPIEN's poses and ours."""

from __future__ import annotations

import math
from typing import Any

import sapien

from momantu_bt.geometry import Transform, quaternion_from_axis_angle
from momantu_worlds.scenes.geometry.bodies import Cylinder, Part

Z_FROM_X = Transform((0, 0, 0), quaternion_from_axis_angle((0, 1, 0), -math.pi / 2))
"""SAPIEN's cylinders lie along x and its planes face x; those of this project are along z."""


def transform_of(pose: Any) -> Transform:
    """A SAPIEN pose as a Transform."""
    return Transform(pose.p, pose.q)


def pose_of(transform: Transform) -> Any:
    """A Transform as a SAPIEN pose."""
    return sapien.Pose(transform.position.tolist(), transform.quaternion.tolist())


def pose_for_sapien(part: Part) -> Transform:
    """Pose in the body of SAPIEN's own shape at which the part has its described pose."""
    if isinstance(part.geometry, Cylinder):
        return part.body_from_part @ Z_FROM_X
    return part.body_from_part

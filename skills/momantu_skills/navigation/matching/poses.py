"""Poses on the floor as arrays (x, y, yaw), for kernels and the pose graph."""

from __future__ import annotations

import math

import numpy as np

from momantu_bt.geometry import Array, Pose2D

ORIGIN = Pose2D(0.0, 0.0)


def as_array(pose: Pose2D) -> Array:
    """(x, y, yaw)."""
    return np.array([pose.x, pose.y, pose.yaw])


def as_pose(pose: Array) -> Pose2D:
    """The pose of an array (3,)."""
    return Pose2D(float(pose[0]), float(pose[1]), math.remainder(float(pose[2]), math.tau))

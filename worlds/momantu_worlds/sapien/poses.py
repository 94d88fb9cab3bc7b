"""Converting between SAPIEN's poses and ours."""

from __future__ import annotations

from typing import Any

import sapien

from momantu_bt.geometry import Transform


def transform_of(pose: Any) -> Transform:
    """A SAPIEN pose as a Transform."""
    return Transform(pose.p, pose.q)


def pose_of(transform: Transform) -> Any:
    """A Transform as a SAPIEN pose."""
    return sapien.Pose(transform.position.tolist(), transform.quaternion.tolist())

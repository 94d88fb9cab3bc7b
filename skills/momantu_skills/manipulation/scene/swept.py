"""The space that an arm would have come to, had nothing stopped it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.messages import RobotState
from momantu_skills.manipulation.model.arm_model import ArmModel
from momantu_skills.manipulation.model.hulls import LinkMask
from momantu_skills.manipulation.scene.columns import HALF_DIAGONAL


def swept(
    model: ArmModel,
    moving: Sequence[str],
    state: RobotState,
    passed: Array,
    ahead: Array,
    edge: float,
) -> Array:
    """Centres (n, 3), odom, of the cells to which links come first at joints `ahead` (n,).

    moving: the links that the arm moves. passed: joints (k, n) at which they met nothing. edge: of
    a cell, m.
    """
    after = _poses(model, moving, state, ahead)
    hulls = {link: model.hulls[link] for link in after}
    corners = [hulls[link] @ pose[:3, :3].T + pose[:3, 3] for link, pose in after.items()]
    grid = _raster(state.odom_from_base.apply(np.vstack(corners)), edge)
    own = state.odom_from_base.inverse().apply(grid)
    kept = LinkMask(hulls, 0.0).covers(own, after)
    touched = LinkMask(hulls, HALF_DIAGONAL * edge)
    for joints in passed:
        kept[kept] = ~touched.covers(own[kept], _poses(model, moving, state, joints))
    return np.asarray(grid[kept])


def _raster(points: Array, edge: float) -> Array:
    """Centres (n, 3) of all cells between the extremes of some points (m, 3)."""
    low = np.floor(points.min(axis=0) / edge).astype(np.int64)
    high = np.ceil(points.max(axis=0) / edge).astype(np.int64)
    cells = np.indices(high - low).reshape(3, -1).T
    return np.asarray((cells + low + 0.5) * edge)


def _poses(
    model: ArmModel, moving: Sequence[str], state: RobotState, joints: Array
) -> dict[str, Array]:
    """Poses base_from_link (4, 4) of some links with the arm at joints (n,)."""
    q = model.configuration(state)
    q[model.group_index] = joints
    poses = model.link_poses(model.follow(q))
    return {link: pose for link, pose in poses.items() if link in moving}

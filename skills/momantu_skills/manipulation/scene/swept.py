"""The space that an arm takes on its way, or would have taken, had nothing stopped it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.messages import RobotState
from momantu_skills.manipulation.model.arm_model import ArmModel
from momantu_skills.manipulation.model.hulls import LinkMask, placed
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
    grid = _raster(state.odom_from_base.apply(_corners(model, after)), edge)
    own = state.odom_from_base.inverse().apply(grid)
    kept = LinkMask(hulls, 0.0).covers(own, after)
    touched = LinkMask(hulls, HALF_DIAGONAL * edge)
    for joints in passed:
        kept[kept] = ~touched.covers(own[kept], _poses(model, moving, state, joints))
    return np.asarray(grid[kept])


def corners_along(
    model: ArmModel, moving: Sequence[str], state: RobotState, postures: Sequence[Array]
) -> Array:
    """Corners (k, n, 3), odom, of the links that the arm moves, at each of k postures (n,).

    n is 0 where none of these links has a shape.
    """
    if not moving:
        return np.empty((len(postures), 0, 3))
    corners = [_corners(model, _poses(model, moving, state, joints)) for joints in postures]
    odom = state.odom_from_base.apply(np.concatenate(corners))
    return np.asarray(odom.reshape(len(postures), -1, 3))


def _corners(model: ArmModel, poses: Mapping[str, Array]) -> Array:
    """Corners (n, 3), base frame, of the hulls of links at some poses."""
    return np.vstack([placed(model.hulls[link], pose) for link, pose in poses.items()])


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

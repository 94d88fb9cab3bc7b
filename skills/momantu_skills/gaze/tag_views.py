"""Views of a tag board that differ from those before, for a camera that the arm carries."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.failure import Failure
from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import JointTrajectory
from momantu_bt.robot import CameraSensor
from momantu_skills.gaze.arm_camera import ON_IT, TESTED, free_postures, start_postures
from momantu_skills.gaze.line_of_sight import line_of_sight
from momantu_skills.manipulation.arm import Arm

OFF_AXIS = 0.2
"""Largest angle of the board's middle to the optical axis, rad, where the hand hides the axis."""
INSIDE = 0.04
"""Room between the board and the picture's edge, as a share of the picture's width."""
LEAST_SIDE = 14.0
"""Shortest side of a tag in the picture, px: about two pixels a cell."""
STEEPEST = np.cos(np.radians(60.0))
"""Cosine of the largest angle between the board's normal and the line of sight."""
NEW = np.radians(8.0)
"""Least angle by which the hand has to be turned against every earlier view, rad."""
PER_SECOND = 0.03
"""How much more a view has to be turned to be worth a second of motion, rad."""


@dataclass(frozen=True, slots=True, eq=False)
class BoardView:
    """A way to another view. turned: against the earlier view that is most like it, rad."""

    way: list[JointTrajectory]
    turned: float


def plan_view(
    arm: Arm, odom_from_board: Transform, corners: Array, earlier: Sequence[Transform]
) -> BoardView:
    """Plan the way to a posture that shows the whole board from where no earlier view did.

    What tells a camera's mounting is how far the hand turns between views, about different axes. So
    each view is the one whose hand is turned farthest against the nearest earlier one, less a
    little for the time to get there (farthest-point sampling of rotations).

    Args:
        arm: it carries the camera.
        odom_from_board: where the board is.
        corners: of its tags (n, 4, 3) in its frame, m.
        earlier: base_from_hand of the earlier views.

    Raises:
        Failure: NO_NEW_VIEW; NO_PLAN, START_IN_COLLISION.
    """
    state, held = arm.state, arm.service.held
    base_from_board = state.odom_from_base.inverse() @ odom_from_board
    point = base_from_board.apply(corners.reshape(-1, 3).mean(axis=0))
    postures, cameras = _aimed(arm, point)
    sensor = arm.scene.model.description.camera()[1]
    shows = _shows(cameras, base_from_board, corners, sensor)
    turned = _turned(arm, cameras, earlier)
    eye = arm.scene.model.eye
    index = [arm.group.names.index(name) for name in eye.names]
    seconds = np.max(np.abs(postures[:, index] - arm.joints[index]) / eye.velocity, axis=1)
    usable = shows & (turned >= NEW)
    order = np.argsort(PER_SECOND * seconds - turned, kind="stable")
    chosen = order[usable[order]][:TESTED]
    for margin in arm.planning.margins:
        world = arm.scene.world(state, held, margin)
        goals = free_postures(arm, world, postures[chosen], point)
        if goals:
            way = arm.route(goals, held)
            last = eye.poses(way[-1].positions[-1][index][None])
            return BoardView(way, float(_turned(arm, last, earlier)[0]))
    raise Failure(
        "NO_NEW_VIEW",
        f"of {int(shows.sum())} postures that show the whole board, {int(usable.sum())} are turned "
        f"by {np.degrees(NEW):.0f} degrees or more against each of {len(earlier)} earlier views, "
        "and none of these is free; bring the robot nearer to the board, or take fewer views",
        shows=int(shows.sum()),
        new=int(usable.sum()),
        earlier=len(earlier),
    )


def _aimed(arm: Arm, point: Array) -> tuple[Array, Array]:
    """Postures (k, n) of the arm that look at a point (3,), and base_from_camera (k, 4, 4)."""
    eye, start = arm.scene.model.eye, arm.joints
    index = [arm.group.names.index(name) for name in eye.names]
    ray = line_of_sight(arm.scene, arm.state, arm.service.held, OFF_AXIS)
    found, off = eye.point(start_postures(arm, start[index], ray, point), ray, point)
    found = eye.nearest_turn(found[off < ON_IT], start[index])
    postures = np.repeat(start[None], len(found), axis=0)
    postures[:, index] = found
    return postures, eye.poses(found)


def _shows(
    cameras: Array, base_from_board: Transform, corners: Array, sensor: CameraSensor
) -> NDArray[np.bool_]:
    """Which cameras (k, 4, 4) see the whole board from its front, and large enough: (k,)."""
    points = base_from_board.apply(corners.reshape(-1, 3))
    seen = np.einsum("kji,knj->kni", cameras[:, :3, :3], points - cameras[:, None, :3, 3])
    depth = seen[..., 2]
    ahead = (depth > sensor.min_depth).all(axis=1) & (depth < sensor.max_depth).all(axis=1)
    focal = sensor.width / 2 / np.tan(sensor.horizontal_fov / 2)
    flat = focal * seen[..., :2] / np.maximum(depth, 1e-6)[..., None]
    room = np.array([sensor.width, sensor.height]) / 2 - INSIDE * sensor.width
    inside = (np.abs(flat) <= room).all(axis=(1, 2))
    tags = flat.reshape(len(cameras), -1, 4, 2)
    sides = np.linalg.norm(tags - np.roll(tags, -1, axis=2), axis=3).min(axis=(1, 2))
    middle = points.mean(axis=0)
    away = cameras[:, :3, 3] - middle
    facing = away @ base_from_board.rotation[:, 2] / np.linalg.norm(away, axis=1)
    return np.asarray(ahead & inside & (sides >= LEAST_SIDE) & (facing >= STEEPEST))


def _turned(arm: Arm, cameras: Array, earlier: Sequence[Transform]) -> Array:
    """Angle (k,) of the hand at cameras (k, 4, 4) against the earlier view most like it, rad."""
    if not earlier:
        return np.full(len(cameras), np.pi)
    kinematics, joints = arm.skill.frames.kinematics, arm.state.joints()
    description = arm.scene.model.description
    hand = kinematics.base_from_frame(description.hand.frame, joints)
    camera = kinematics.base_from_frame(description.camera()[1].frame, joints)
    hands = cameras[:, :3, :3] @ (camera.rotation.T @ hand.rotation)
    before = np.stack([each.rotation for each in earlier])
    traces = np.einsum("kij,eij->ke", hands, before)
    return np.asarray(np.arccos(np.clip((traces - 1) / 2, -1.0, 1.0)).min(axis=1))

"""The space between the gripper's pads in a depth picture: what is in it, and what is behind it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.service import Snapshot
from momantu_skills.manipulation.model.hulls import LinkMask
from momantu_skills.manipulation.scene.scene import Scene
from momantu_skills.perception.camera.cloud import points_from_depth

STRIDE = 2
"""Every n-th pixel in each direction is used: 2 mm apart at 0.6 m."""
PAD = 0.008
"""Distance from the pads' faces within which a point may be a finger's, m."""
OWN = 0.005
"""Margin around the links of the hand, m: what is held touches them."""
BESIDE = 0.015
"""How far above and below the pads what is between them is looked for, m."""
BEHIND = 0.03
"""Distance behind a place from which the picture shows through it, m: noise and mounting errors."""
STEPS = (5, 5, 3)
"""Places between the pads that are looked at, along x, y, z."""


@dataclass(frozen=True, slots=True)
class View:
    """What a picture shows there.

    points: how many lie between the pads and are not the robot's. through: share of the space
    between the pads behind which the picture shows something farther away, 0..1.
    """

    points: int
    through: float


def between_pads(scene: Scene, snapshot: Snapshot) -> View:
    """What a picture shows between the pads; nothing where the fingers are shut."""
    hand, state = scene.model.description.hand, snapshot.state
    poses = scene.model.link_poses(scene.model.configuration(state))
    base_from_grasp = Transform.from_matrix(poses[hand.frame]) @ scene.model.tip_from_grasp
    half = np.array([hand.pad_length, state.gripper_width - 2 * PAD, hand.pad_height]) / 2
    if half[1] <= 0.0:
        return View(0, 0.0)
    base_from_camera = snapshot.odom_from_base.inverse() @ snapshot.odom_from_camera
    image = snapshot.image
    points = base_from_camera.apply(points_from_depth(image.depth, image.intrinsics, STRIDE))
    local = base_from_grasp.inverse().apply(points)
    within = (np.abs(local) <= half + np.array([0.0, 0.0, BESIDE])).all(axis=1)
    hulls = scene.model.hulls
    links = {name: hulls[name] for name in hand.touch_links if name in hulls}
    own = LinkMask(links, OWN).covers(points[within], poses)
    through = _through(base_from_camera.inverse() @ base_from_grasp, half, snapshot)
    return View(int((~own).sum()), through)


def _through(camera_from_grasp: Transform, half: Array, snapshot: Snapshot) -> float:
    axes = [np.linspace(-h, h, n) * 0.8 for h, n in zip(half, STEPS, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    places, image = camera_from_grasp.apply(grid), snapshot.image
    z = np.maximum(places[:, 2], 1e-3)
    u = np.rint(places[:, 0] / z * image.intrinsics[0, 0] + image.intrinsics[0, 2]).astype(int)
    v = np.rint(places[:, 1] / z * image.intrinsics[1, 1] + image.intrinsics[1, 2]).astype(int)
    height, width = image.depth.shape
    seen = (places[:, 2] > 0.0) & (u >= 0) & (u < width) & (v >= 0) & (v < height)
    depth = image.depth[v[seen], u[seen]]
    return float((depth > z[seen] + BEHIND).sum() / len(grid))

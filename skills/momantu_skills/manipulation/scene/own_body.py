"""Where the robot's links are, and what its hand holds: outlines, corners, points of pictures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_bt.messages import RobotState
from momantu_bt.service import HeldObject
from momantu_skills.manipulation.model.arm_model import ArmModel
from momantu_skills.manipulation.model.collision import BodyPairs, body_pairs
from momantu_skills.manipulation.model.hulls import (
    LinkMask,
    floor_outline,
    object_corners,
    placed,
)
from momantu_skills.manipulation.scene import outreach
from momantu_skills.manipulation.scene.swept import corners_along

TURNED = 0.25
"""How far what is held may have turned in the hand, rad: a wide bowl hangs down from its rim."""


class OwnBody:
    """The robot in a state, with what it holds; all in the base frame unless said otherwise."""

    def __init__(self, model: ArmModel, padding: float) -> None:
        """padding: distance from a link up to which points of pictures belong to it, m."""
        self.model, self._padding = model, padding
        self._mask = LinkMask(model.hulls, padding)

    @cached_property
    def pairs(self) -> BodyPairs:
        """The robot's shapes, and the pairs of links that the arm can bring together."""
        return body_pairs(self.model)

    def corners(self, state: RobotState, held: HeldObject | None) -> list[Array]:
        """Corners (n, 3) of each link, and at last of the held object."""
        poses = self.model.link_poses(self.model.configuration(state))
        corners = [placed(hull, poses[link]) for link, hull in self.model.hulls.items()]
        if held is not None:
            tip = poses[self.model.description.hand.frame]
            corners.append(placed(self.held_corners(held), tip))
        return corners

    def held_corners(self, held: HeldObject, padding: float = 0.0) -> Array:
        """Corners (n, 3) of the held object, in the tip's frame, m."""
        tip_from_object = self.model.tip_from_grasp @ held.grasp_from_object
        return tip_from_object.apply(object_corners(held.object, padding))

    def along(self, state: RobotState, postures: Sequence[Array]) -> Array:
        """Corners (k, n, 3), odom, of the links that the arm moves, at each of k postures (n,)."""
        return corners_along(self.model, self.pairs.moving, state, postures)

    def footprint(
        self, state: RobotState, held: HeldObject | None, below: float = math.inf
    ) -> Array:
        """See `PlanningScene.footprint`."""
        corners = [each for each in self.corners(state, held) if each[:, 2].min() < below]
        outline = np.array([(x, y, 0.0) for x, y in self.model.description.footprint])
        everything = np.vstack([*corners, outline])
        return floor_outline(everything[everything[:, 2] < self.model.description.height])

    def overhang(self, state: RobotState, held: HeldObject | None) -> Array:
        """See `BodyScene.overhang`."""
        base = np.array(self.model.description.footprint)
        height = self.model.description.height
        parts = [part for part in self.corners(state, held) if part[:, 2].min() < height]
        return outreach.overhang(parts, base)

    def covers(
        self, points: Array, state: RobotState, held: HeldObject | None
    ) -> NDArray[np.bool_]:
        """See `PlanningScene.is_robot`."""
        poses = self.model.link_poses(self.model.configuration(state))
        own = self._mask.covers(points, poses)
        if held is not None:
            tip = poses[self.model.description.hand.frame]
            corners = self.held_corners(held)
            across = np.linalg.norm(corners - self.model.tip_from_grasp.position, axis=1).max()
            padding = max(self._padding, TURNED * float(across))
            mask = LinkMask({"held": corners}, padding)
            own |= mask.covers(points, {"held": tip})
        return own

    def hides(self, points: Array, joints: Array) -> bool:
        """Whether a link hides one of points (n, 3) with the arm at joints (n,)."""
        posed = dict(zip(self.model.group.names, joints, strict=True))
        poses = self.model.link_poses(self.model.posture(posed, 0.0))
        return bool(self._mask.covers(points, poses).any())

"""The measures of a robot that decide whether it can work in a world."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely

from momantu_bt.failure import Failure
from momantu_bt.frames import KinematicTree
from momantu_bt.geometry import Array, Pose2D
from momantu_bt.robot import CameraSensor, RobotDescription
from momantu_bt.world import seeded

SAMPLES = 2000
"""Random configurations of the arm that sample its reach."""
FREE_TURN = math.pi
"""rad; sampled range of a continuous joint, either way."""
EYES = ("look_around", "ready")
"""Named poses in which the camera looks at objects."""


@dataclass(frozen=True, eq=False)
class Measures:
    """The measures of a robot that matter to a world.

    footprint: (n, 2) corners of the base in its frame. half_width: from the middle to the nearest
    edge, m. height: below which everything is in its way, m. reach: (nearest, best, farthest) m
    from the middle of the base. eyes: heights of the camera, m. hand: (n, 2) where the grasp
    frame gets: distance from the base's middle along the floor, and height, m. max_width: of what
    the hand can hold, m. camera: the one that looks at tags.
    """

    name: str
    footprint: Array
    half_width: float
    height: float
    reach: tuple[float, float, float]
    eyes: tuple[float, ...]
    hand: Array
    max_width: float
    camera: CameraSensor | None = None

    def outline(self, pose: Pose2D) -> Array:
        """Corners (n, 2) of the base as it stands somewhere."""
        points = np.column_stack([self.footprint, np.zeros(len(self.footprint))])
        return pose.transform().apply(points)[:, :2]

    def works_at(self, height: float) -> bool:
        """Whether the hand reaches objects on a surface of this height, before the base.

        A posture counts if the hand is at most `GRASP` above the surface and beyond the base's
        front.
        """
        front = float(self.footprint[:, 0].max()) + FRONT
        out, up = self.hand[:, 0], self.hand[:, 1]
        good = (out >= front) & (up >= height + GRASP[0]) & (up <= height + GRASP[1])
        return int(good.sum()) >= ENOUGH


GRASP = (0.03, 0.20)
"""Range of heights above a surface in which the hand grasps, m."""
FRONT = 0.10
"""Distance before the base's front, m: a surface's edge is no nearer, and objects stand behind
it."""
ENOUGH = 3
"""Fewest of `SAMPLES` configurations that must reach; fewer are outliers at the limit of the
reach."""


def measured(description: RobotDescription) -> Measures:
    """The measures of a robot; self-collision is ignored."""
    kinematics = description.kinematics()
    footprint = np.array(description.footprint, dtype=np.float64)
    return Measures(
        name=description.name,
        footprint=footprint,
        half_width=_inner_radius(footprint),
        height=description.height,
        reach=description.working.reach or (0.0, 0.0, 0.0),
        eyes=_eyes(description, kinematics),
        hand=_hand(description, kinematics),
        max_width=0.0 if description.end_effector is None else description.hand.max_width,
        camera=_camera(description),
    )


def _inner_radius(corners: Array) -> float:
    """Distance from the origin to the nearest edge of a polygon around it."""
    return float(shapely.Polygon(corners).exterior.distance(shapely.Point(0.0, 0.0)))


def _camera(description: RobotDescription) -> CameraSensor | None:
    try:
        return description.camera()[1]
    except KeyError:
        return None


def _eyes(description: RobotDescription, kinematics: KinematicTree) -> tuple[float, ...]:
    camera = _camera(description)
    if camera is None:
        return ()
    frame, heights = camera.frame, []
    for name in EYES:
        pose = description.named_poses.get(name)
        if pose is not None:
            try:
                heights.append(float(kinematics.base_from_frame(frame, pose).position[2]))
            except Failure:  # the camera is on a frame that the robot lacks: another check's word
                return ()
    return tuple(dict.fromkeys(heights))


def _hand(description: RobotDescription, kinematics: KinematicTree) -> Array:
    """(n, 2) distance and height of the grasp frame in random postures of the joints below it."""
    if description.end_effector is None:
        return np.zeros((0, 2))
    effector = description.hand
    draw = seeded("reach of", description.name)
    matrices = np.broadcast_to(np.eye(4), (SAMPLES, 4, 4))
    for joint in kinematics.chain(effector.frame):
        limits = description.joint_limits.get(joint.name)
        if limits is None or joint.kind == "fixed":
            matrices = matrices @ joint.transform(0.0)
            continue
        low = -FREE_TURN if limits.lower is None else limits.lower
        high = FREE_TURN if limits.upper is None else limits.upper
        positions = draw.uniform(low, high, SAMPLES)
        matrices = matrices @ np.stack([joint.transform(float(p)) for p in positions])
    tip = matrices @ np.array([effector.grasp_offset, 0.0, 0.0, 1.0])
    return np.column_stack([np.hypot(tip[:, 0], tip[:, 1]), tip[:, 2]])

"""The base: its frame, virtual joints above it, wheels, footprint."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from momantu_bt.geometry import Array
from momantu_skills.robot_setup.urdf.body import Body
from momantu_skills.robot_setup.urdf.skeleton import TURNING, SetupJoint, Skeleton

NAMES = ("base_footprint", "base_link", "base")
"""Usual names of base links, the one on the floor first."""
ABOVE = 0.25
"""Height above the floor up to which shapes belong to the footprint, m."""
ON_FLOOR = 0.03
"""Height above the robot's lowest point within which a wheel touches the floor, m."""
OVER_FLOOR = 0.05
"""Height above the floor, m, below which links of the base may touch an uneven floor."""
CORNERS = 12
"""Most corners of a footprint: enough for a round base."""
THIN = 1e-3
"""A side is removed if the footprint grows by less than this, m."""
WHEEL = 0.5
"""Largest size of a wheel with its fork, m."""
LEVEL = 0.2
"""Largest vertical component of a wheel's axis (unit vector)."""


@dataclass(frozen=True)
class BaseFrame:
    """frame: the link that defines the robot's pose. virtual: joints above it that move it."""

    frame: str
    virtual: tuple[str, ...] = ()


@dataclass(frozen=True)
class Stand:
    """How the robot stands: links on the floor, outline, height of the floor in the base, mass.

    A robot whose lowest shape lies above its base frame has wheels without shapes.
    fixed: links of the base itself. wheels: links that roll. grounded: those of both that reach
    down to the floor. low: (n, 2) corners of what stands there, up to ABOVE. footprint: (k, 2), m,
    around those, or None where the base has no shape. floor: m, 0 where the base frame lies on
    the floor.
    """

    fixed: tuple[str, ...]
    wheels: tuple[str, ...]
    grounded: tuple[str, ...]
    low: Array
    footprint: Array | None
    floor: float
    mass: float

    @property
    def width(self) -> float:
        """Of the footprint across, m."""
        return 0.0 if self.footprint is None else float(np.ptp(self.footprint[:, 1]))

    @property
    def front(self) -> float:
        """Of the footprint from the base frame ahead, m."""
        return 0.0 if self.footprint is None else float(self.footprint[:, 0].max())


def find_base(skeleton: Skeleton) -> BaseFrame:
    """The root of the robot, below joints that only place the robot in a world."""
    link = skeleton.root
    virtual: list[str] = []
    while not any(skeleton.links[name].collisions for name in skeleton.rigid(link)):
        if planar(skeleton, tuple(virtual)) is not None:
            break
        below = [j for name in skeleton.rigid(link) for j in skeleton.below(name)]
        leaving = [joint for joint in below if joint.kind != "fixed"]
        if len(leaving) != 1 or not _places(leaving[0]):
            break
        virtual.append(leaving[0].name)
        link = leaving[0].child
    return BaseFrame(_named(skeleton, link), tuple(virtual))


def planar(skeleton: Skeleton, virtual: tuple[str, ...]) -> tuple[str, str, str] | None:
    """Joints above a base as (x, y, yaw) where that is what they are."""
    joints = [skeleton.joints[name] for name in virtual]
    if [j.kind == "prismatic" for j in joints] != [True, True, False]:
        return None
    axes = np.abs([j.axis for j in joints])
    if not np.allclose(axes, np.eye(3), atol=1e-3):
        return None
    x, y, yaw = virtual
    return x, y, yaw


def _places(joint: SetupJoint) -> bool:
    if joint.kind in ("floating", "planar"):
        return True
    return joint.moving and float(np.linalg.norm(joint.parent_from_joint.position)) < 1e-6


def _named(skeleton: Skeleton, link: str) -> str:
    candidates = [skeleton.rigid_root(link)]
    while not skeleton.links[candidates[-1]].collisions:
        below = skeleton.below(candidates[-1])
        if len(below) != 1 or below[0].moving:
            break
        candidates.append(below[0].child)
    for name in NAMES:
        if name in candidates:
            return name
    return candidates[-1] if candidates[0] in ("world", "map", "odom") else candidates[0]


def find_stand(body: Body) -> Stand:
    """What is fixed to the base, what rolls, and the outline of both."""
    skeleton = body.skeleton
    below = set(skeleton.subtree(body.base_frame))
    fixed = tuple(link for link in skeleton.rigid(body.base_frame) if link in below)
    floor = min(body.lowest({}), 0.0)
    wheels = tuple(
        link
        for joint in _rolling(body, floor)
        if joint.child in below
        for link in skeleton.subtree(joint.child)
    )
    points = body.points((*fixed, *wheels), {})
    low = points[points[:, 2] < floor + ABOVE]
    low = low if len(low) else points
    mass = sum(skeleton.links[link].mass for link in below)
    grounded = tuple(link for link in (*fixed, *wheels) if _touches(body, link, floor))
    return Stand(fixed, wheels, grounded, low[:, :2], outline(low), floor, mass)


def _touches(body: Body, link: str, floor: float) -> bool:
    corners = body.corners((link,), {})
    return len(corners) > 0 and float(corners[:, 2].min()) < floor + OVER_FLOOR


def _rolling(body: Body, floor: float) -> Iterator[SetupJoint]:
    """The joints that carry wheels: on the base, or on what it is suspended by."""
    for joint in body.skeleton.branches(body.base_frame):
        if _rolls(body, joint, floor):
            yield joint
        else:
            below = body.skeleton.branches(joint.child)
            yield from (each for each in below if _rolls(body, each, floor))


def _rolls(body: Body, joint: SetupJoint, floor: float) -> bool:
    links = body.skeleton.subtree(joint.child)
    turning = [j for j in (joint, *body.skeleton.moving_below(joint.child)) if j.kind in TURNING]
    corners = body.corners(links, {})
    if not len(corners) or not any(j.endless for j in turning):
        return False
    size = np.ptp(corners, axis=0).max()
    if corners[:, 2].min() > floor + ON_FLOOR or size > WHEEL:
        return False
    return any(_level(body, j) for j in turning if j.endless)


def _level(body: Body, joint: SetupJoint) -> bool:
    """Whether a joint's axis is level; one of the three of a ball is."""
    axis = body.link_poses({})[joint.child][:3, :3] @ np.array(joint.axis)
    return bool(abs(axis[2]) < LEVEL * np.linalg.norm(axis))


def outline(points: Array) -> Array | None:
    """Convex outline (k, 2) of points (n, 3) seen from above, counter-clockwise, in whole mm.

    It encloses them, with CORNERS sides at most. None for no area.
    """
    if len(points) < 3:
        return None
    try:
        flat = points[:, :2]
        corners = _enclosing(flat[ConvexHull(flat).vertices])
    except QhullError:
        return None
    return np.sign(corners) * np.ceil(np.abs(corners) * 1000 - 1e-6) / 1000


def _enclosing(corners: Array) -> Array:
    """A polygon around a convex one (n, 2) that has few sides and is only slightly larger.

    Sides are removed one by one, and their neighbours extended until they meet. The next side is
    the one with the smallest extension, while there are too many sides or the extension is less
    than THIN.
    """
    while len(corners) > 3:
        tips, heights = _without_sides(corners)
        least = int(np.argmin(heights))
        if not np.isfinite(heights[least]):
            break
        if len(corners) <= CORNERS and heights[least] >= THIN:
            break
        corners = np.roll(corners, -least, axis=0)
        corners = np.vstack([tips[least], corners[2:]])
    return corners


def _without_sides(corners: Array) -> tuple[Array, Array]:
    """Where the neighbours of each side meet, (n, 2), and how far beyond it, (n,).

    Infinitely far where they do not.
    """
    ends = np.roll(corners, -1, axis=0)
    way = ends - corners
    before, after = np.roll(way, 1, axis=0), np.roll(way, -1, axis=0)
    turn = _cross(before, after)
    meet = turn > 1e-12
    reach = _cross(way, after) / np.where(meet, turn, 1.0)
    tips = corners + reach[:, None] * before
    length = np.maximum(np.linalg.norm(way, axis=1), 1e-12)
    heights = _cross(tips - corners, way) / length
    return tips, np.where(meet, heights, np.inf)


def _cross(one: Array, other: Array) -> Array:
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])

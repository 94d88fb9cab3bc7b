"""The line of sight of a camera on the hand, past the hand and what it holds."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from momantu_bt.failure import Failure
from momantu_bt.geometry import Array
from momantu_bt.messages import RobotState
from momantu_bt.service import HeldObject
from momantu_skills.manipulation.model.hulls import placed
from momantu_skills.manipulation.scene.scene import Scene

ENOUGH = math.radians(12.0)
"""Angle around the line of sight that should be free of the hand, rad; more gives no advantage."""
LEAST = math.radians(3.0)
"""Angle around it below which the held object hides the view, rad."""
DIRECTIONS = 12
"""Number of directions in which the line of sight may move off the optical axis."""
BEFORE = 0.03
"""Distance before the lens above which a body hides something, m; the camera's housing is
nearer."""
LENS = 0.02
"""Distance around the lens within which a body belongs to the camera, m."""


def line_of_sight(scene: Scene, state: RobotState, held: HeldObject | None, within: float) -> Array:
    """Unit vector (3,) in the optical frame of a line of sight that passes hand and held object.

    It is the optical axis if that is free, else the nearest direction at most `within` rad off it.

    Raises:
        Failure: OUT_OF_VIEW if the held object or the hand itself hides all directions.
    """
    rays = _rays(within)
    bodies = _in_the_way(scene, state, held)
    free = [min((clearance(ray, body) for body in bodies), default=math.pi) for ray in rays]
    best = max(range(len(rays)), key=lambda i: (min(free[i], ENOUGH), rays[i, 2], -i))
    if free[best] < LEAST:
        what = "the hand" if held is None else f"the {held.object.category} in the hand"
        raise Failure("OUT_OF_VIEW", f"{what} hides the view of the camera that the arm carries")
    return np.asarray(rays[best])


def _rays(within: float) -> Array:
    """(n, 3) the optical axis, and directions around it."""
    turns = 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    found = [np.array([[0.0, 0.0, 1.0]])]
    for off in (0.5 * within, within):
        around = math.sin(off) * np.column_stack([np.cos(turns), np.sin(turns)])
        found.append(np.column_stack([around, np.full(DIRECTIONS, math.cos(off))]))
    return np.vstack(found)


def _in_the_way(scene: Scene, state: RobotState, held: HeldObject | None) -> list[Array]:
    """Outlines (k, 2), x / z and y / z in the optical frame, of what moves with the camera."""
    model, eye = scene.model, scene.model.eye
    poses = model.link_poses(model.configuration(state))
    camera = eye.tip_pose(np.array([state.position(name) for name in eye.names]))
    bodies = {
        link: placed(hull, poses[link])
        for link, hull in model.hulls.items()
        if link in model.beyond_eye
    }
    if held is not None:
        tip = poses[model.description.hand.frame]
        bodies["held"] = placed(scene.own.held_corners(held), tip)
    seen = (camera.inverse().apply(corners) for corners in bodies.values())
    outlines = (outline(corners) for corners in seen if not _around_lens(corners))
    return [found for found in outlines if found is not None]


def _around_lens(corners: Array) -> bool:
    """Whether a convex body (n, 3), optical frame, is around the lens: see `LENS`."""
    return bool((ConvexHull(corners).equations[:, 3] <= LENS).all())


def outline(corners: Array) -> Array | None:
    """Convex outline (k, 2) of a convex body's corners (n, 3) in the camera's view; see `BEFORE`.

    x / z and y / z of the optical frame, counter-clockwise. None if the body is behind the camera.
    """
    first, second = corners[:, None], corners[None]
    rise = second[..., 2] - first[..., 2]
    crossing = (first[..., 2] < BEFORE) & (second[..., 2] > BEFORE)
    share = (BEFORE - first[..., 2]) / np.where(crossing, rise, 1.0)
    cut = (first + share[..., None] * (second - first))[crossing]
    seen = np.vstack([corners[corners[:, 2] >= BEFORE], cut])
    if len(seen) < 3:
        return None
    flat = seen[:, :2] / seen[:, 2:]
    try:
        return np.asarray(flat[ConvexHull(flat).vertices])
    except QhullError:
        return None


def clearance(ray: Array, seen: Array) -> float:
    """Angle from a ray (3,) to the nearest point of an outline (k, 2), rad; 0 inside."""
    first = np.column_stack([seen, np.ones(len(seen))])
    second = np.roll(first, -1, axis=0)
    inward = np.cross(first, second)
    inward /= np.linalg.norm(inward, axis=1, keepdims=True)
    beyond = inward @ ray
    if (beyond >= 0.0).all():
        return 0.0
    foot = ray - beyond[:, None] * inward
    left = np.einsum("ki,ki->k", np.cross(first, foot), inward) >= 0.0
    right = np.einsum("ki,ki->k", np.cross(foot, second), inward) >= 0.0
    nearest = np.vstack([first, foot[left & right]])
    cosines = nearest @ ray / np.linalg.norm(nearest, axis=1)
    return float(np.arccos(np.clip(cosines, -1.0, 1.0)).min())

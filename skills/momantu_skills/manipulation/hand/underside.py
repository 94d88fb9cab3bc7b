"""How much room an arm leaves below itself for what stands beside the object in its hand."""

from __future__ import annotations

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import DetectedObject
from momantu_skills.manipulation.arm import Arm
from momantu_skills.manipulation.hand.resting import lies, rise
from momantu_skills.manipulation.model.hulls import placed

FINGERS = 0.06
"""Distance from the object up to which nothing stands where it is put down, m: the open fingers
need as much."""
FAR = 0.35
"""Distance from the object's axis beyond which the arm is above other things, m."""
LOW_PENALTY = 4.0
"""Cost of an arm that lies on the surface behind its hand, s. Among other things the object cannot
be put down so: every fifth goal has some, and two tries that fail take 20 s."""


def low_penalty(arm: Arm, thing: DetectedObject, q: Array) -> float:
    """Cost of holding an object with the arm at joints (n,), s: 0 if the arm is above it.

    Things beside the object are taken to be at most as tall as itself, each height as likely. So
    the cost grows with the share of the object's height in which the arm is in their way.
    """
    base_from_object = arm.state.odom_from_base.inverse() @ thing.pose.transform
    half = rise(thing, thing.pose.transform)
    bottom = float(base_from_object.position[2]) - half
    room = _underside(arm, thing, base_from_object, q) - bottom
    return LOW_PENALTY * min(1.0, max(0.0, 1.0 - room / (2 * half)))


def _underside(arm: Arm, thing: DetectedObject, base_from_object: Transform, q: Array) -> float:
    """Height in base of the arm's lowest corner behind the fingers' room, m; infinite if none."""
    model = arm.scene.model
    posed = dict(zip(arm.group.names, q, strict=True))
    poses = model.link_poses(model.posture({**arm.state.joints(), **posed}, arm.open_width))
    corners = np.vstack(
        [placed(model.hulls[link], poses[link]) for link in arm.scene.own.pairs.moving]
    )
    away = np.linalg.norm(corners[:, :2] - base_from_object.position[:2], axis=1)
    wide = max(thing.size if lies(thing) else thing.size[:2]) / 2
    beside = (away > wide + FINGERS) & (away < FAR)
    return float(corners[beside, 2].min(initial=np.inf))

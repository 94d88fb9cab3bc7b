"""Which grasps of an object come into question: by its body, its rim or its handle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from momantu_bt.categories import HANDLED
from momantu_bt.failure import Failure
from momantu_bt.geometry import Array
from momantu_bt.messages import DetectedObject
from momantu_skills.manipulation.arm import Arm
from momantu_skills.manipulation.config import Hold
from momantu_skills.manipulation.hand.grasps import Floor, Grasp, grasps_for, over_rim
from momantu_skills.manipulation.hand.handles import Handle, handle_grasps, seen_handle
from momantu_skills.manipulation.hand.resting import lies
from momantu_skills.manipulation.hand.rims import seen_hollow, seen_rim
from momantu_skills.manipulation.hand.sides import Sides, sentence

AROUND, STEP = 0.05, 0.008
"""How far around a lying object the surface is looked at, and how closely, m."""
NO_RIM = "no picture shows room for a finger behind its rim"
NO_HANDLE = "no picture shows one; it may be behind the object"
ON_SIDE = "the object lies on its side"


@dataclass(frozen=True, eq=False)
class Options:
    """Grasps that come into question, and the handle that was seen.

    missing: why there are none by a part that was asked for.
    """

    grasps: list[Grasp]
    handle: Handle | None = None
    missing: Mapping[str, str] = field(default_factory=dict)

    def handle_corners(self, thing: DetectedObject) -> list[Array]:
        """Corners (8, 3) of a box around the handle in the object's frame, m, if there is one."""
        return [] if self.handle is None else [self.handle.corners(max(thing.size[:2]) / 2)]


def options_for(arm: Arm, thing: DetectedObject, by: Hold = "any") -> Options:
    """The grasps for which the hand is wide enough, by the part that is asked for.

    by: with "any" the body comes first. What is too wide for that is held by its rim
    or its handle, where a picture shows room for a finger, or the handle. Where nothing is left,
    grasps for which the hand is hardly large enough.

    Raises:
        Failure: NO_GRASP if there are none.
    """
    handle = None
    if _may_have_handle(thing, by):
        handle = seen_handle(arm.scene.recent.points_since(_still(arm)), thing)
    found: list[Grasp] = []
    missing: dict[str, str] = {}
    if by in ("any", "body"):
        found = [grasp for grasp in _of_body(arm, thing) if grasp.part == "body"]
    if by == "rim" or (by == "any" and not found):
        found += _by_rim(arm, thing)
        if not any(grasp.rim for grasp in found):
            missing["rim"] = ON_SIDE if lies(thing) else NO_RIM
    if by == "handle" or (by == "any" and not found and thing.category in HANDLED):
        held = _by_handle(arm, thing, handle)
        found += held
        if not held:
            missing["handle"] = ON_SIDE if lies(thing) else NO_HANDLE
    if by in ("any", "body") and not found:
        found = [g for g in _of_body(arm, thing, tight=True) if g.part == "body"]
    if not found:
        raise _none(arm, thing, by, missing)
    return Options(found, handle, missing)


def _still(arm: Arm) -> float:
    """Since when nothing was touched, nor the pictures too old for a grasp, s."""
    return max(arm.service.last_contact, arm.state.stamp - arm.hand.old_pose)


def _may_have_handle(thing: DetectedObject, by: Hold) -> bool:
    return not lies(thing) and (by == "handle" or thing.category in HANDLED)


def _of_body(arm: Arm, thing: DetectedObject, tight: bool = False) -> list[Grasp]:
    model = arm.scene.model
    return grasps_for(
        thing,
        model.description.hand,
        model.palm,
        model.open_fingers,
        tight,
        model.fingers_at,
        floor_below(thing) if lies(thing) else None,
    )


def _by_rim(arm: Arm, thing: DetectedObject) -> list[Grasp]:
    """Grasps over the rim that pictures show room for."""
    if lies(thing):
        return []
    model, space, seen = arm.scene.model, arm.scene.seen_space, arm.scene.points
    found = over_rim(thing, model.description.hand)
    found = [grasp for grasp in found if seen_rim(seen, thing, grasp)]
    return [g for g in found if seen_hollow(space, thing, g, model.open_fingers)]


def _by_handle(arm: Arm, thing: DetectedObject, handle: Handle | None) -> list[Grasp]:
    if handle is None:
        return []
    model = arm.scene.model
    return handle_grasps(thing, handle, model.description.hand, model.palm, model.fingers_at)


def floor_below(thing: DetectedObject) -> Floor:
    """The surface below a lying object: points of it under the object and around it."""
    odom_from_object = thing.pose.transform
    radius, length = max(thing.size[:2]) / 2 + AROUND, thing.size[2] / 2 + AROUND
    up = odom_from_object.rotation[2]
    side = np.cross((0.0, 0.0, 1.0), up)
    down = odom_from_object.position[2] - thing.support_height
    across = np.arange(-radius, radius + STEP / 2, STEP)
    along = np.arange(-length, length + STEP / 2, STEP)
    a, b = (part.ravel()[:, None] for part in np.meshgrid(across, along))
    return Floor(up, a * side + b * np.array((0.0, 0.0, 1.0)) - down * up)


def _none(arm: Arm, thing: DetectedObject, by: Hold, missing: Mapping[str, str]) -> Failure:
    """The failure where no grasp comes into question."""
    widest = arm.scene.model.description.hand.max_width
    sides = Sides(arm, thing).told(()) if by in ("any", "body") else {}
    sides = {**sides, **missing}
    asked = "" if by == "any" else f", and it is to be held by its {by}"
    return Failure(
        "NO_GRASP",
        f"the {thing.category} measures {thing.size[0] * 1000:.0f} x "
        f"{thing.size[1] * 1000:.0f} mm, the gripper opens to {widest * 1000:.0f} mm{asked}: "
        f"{sentence(sides)}",
        sides=sides,
    )

"""From which sides grasps of an object were tried, and why each of them fell out, in words."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.messages import DetectedObject
from momantu_skills.manipulation.arm import Arm
from momantu_skills.manipulation.hand.grasps import OPENING, Grasp, approaches
from momantu_skills.manipulation.model.collision import CollisionWorld

STEEP = math.radians(60.0)
"""Angle of the fingers below the horizontal from which a grasp is one from above, rad."""
SHOWN = 2
"""Most pairs that touch which a reason names."""
AROUND = "the hand would have to reach around it"


class Sides:
    """Notes what became of the grasps of one object, side by side, as seen from the base."""

    def __init__(self, arm: Arm, thing: DetectedObject) -> None:
        self._arm, self._thing = arm, thing
        self._base_from_object = arm.state.odom_from_base.inverse() @ thing.pose.transform
        self._steps: dict[str, Counter[str]] = {}
        self._first: dict[str, tuple[Array, Sequence[CollisionWorld]]] = {}

    def lost(self, grasp: Grasp, step: str, q: Array, *worlds: CollisionWorld) -> None:
        """Note that a grasp with joints (n,) failed at a step, as something touches in `worlds`."""
        side = self.side_of(grasp)
        self._steps.setdefault(side, Counter())[step] += 1
        if worlds and side not in self._first:
            self._first[side] = (q, worlds)

    def side_of(self, grasp: Grasp) -> str:
        """The side from which the hand comes: above, front, left, right or back; or the part."""
        if grasp.part != "body":
            return grasp.part
        return self._side(grasp.object_from_grasp.rotation[:, 0])

    def told(self, grasps: Sequence[Grasp]) -> dict[str, str]:
        """Why no grasp was left, by side. grasps: those that were tried."""
        widest = self._arm.scene.model.description.hand.max_width
        reasons: dict[str, str] = {}
        for width, direction, top in approaches(self._thing):
            if width > widest - OPENING:
                level = (math.cos(direction), math.sin(direction), 0.0)
                side = self._side(np.array((0.0, 0.0, -1.0) if top else level))
                text = (
                    f"{width * 1000:.0f} mm wide there, the hand opens to {widest * 1000:.0f} mm "
                    f"and needs {OPENING * 1000:.0f} mm more than the width"
                )
                reasons.setdefault(side, text)
        for grasp in grasps:
            side = self.side_of(grasp)
            reasons.setdefault(
                side, AROUND if side == "back" else "no posture of the arm reaches it"
            )
        for side, steps in self._steps.items():
            counts = ", ".join(f"{n} at {step}" for step, n in steps.items())
            reasons[side] = counts + self._touching(side)
        return reasons

    def _touching(self, side: str) -> str:
        """What touches in the first posture that was lost on a side, in brackets, or nothing."""
        if side not in self._first:
            return ""
        q, worlds = self._first[side]
        pairs = {f"{a} meets {_plainly(b)}": None for each in worlds for a, b in each.touching(q)}
        return f" ({' and '.join(list(pairs)[:SHOWN])})" if pairs else ""

    def _side(self, direction: Array) -> str:
        """The side from which fingers come along a direction (3,) in the object's frame."""
        ahead = self._base_from_object.rotation @ direction
        if -ahead[2] > math.sin(STEEP):
            return "above"
        away = self._base_from_object.position[:2]
        along, across = away @ ahead[:2], away[0] * ahead[1] - away[1] * ahead[0]
        if abs(along) >= abs(across):
            return "front" if along > 0.0 else "back"
        return "right" if across > 0.0 else "left"


def sentence(reasons: dict[str, str]) -> str:
    """All sides with their reasons, for a message."""
    return "; ".join(f"{side}: {reason}" for side, reason in reasons.items())


def _plainly(name: str) -> str:
    """What a collision world calls an obstacle, in words."""
    if name.startswith("support"):
        return "the surface"
    return {"cells": "what pictures show", "target": "the object itself"}.get(name, name)

"""All bundled skills pass `check_skill`: in the room that is made for any, and where they work."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import pytest
from momantu_skills.manipulation.scene.service import PlanningSceneService
from momantu_skills.pick import Pick
from momantu_skills.place import Place

from momantu_bt.formats.problems import Severity
from momantu_bt.geometry import Pose, Transform
from momantu_bt.messages import DetectedObject, SupportPlane
from momantu_bt.robot import Robot
from momantu_bt.skill import Skill
from momantu_bt.testing import ScriptedWorld, check_skill
from momantu_bt.tree.plugins import SKILLS
from momantu_bt.tree.registry import Registry
from tests.skills.scenery.table import Tabletop

HAND_FROM_CAN = Transform((0.007, 0.0, 0.0))
"""Gripped from the side: upright while the hand is level."""

BUNDLED = [
    name
    for name, kind in Registry.installed().skills.items()
    if kind.__module__.startswith("momantu_skills.")
]


@pytest.mark.parametrize("name", BUNDLED)
def test_a_bundled_skill_keeps_what_every_skill_promises(name: str) -> None:
    kind: type[Skill] = SKILLS.load(name)
    found = check_skill(kind, halts=4)
    assert [str(finding) for finding in found if finding.severity is not Severity.HINT] == []
    # the robot of that room has nothing in its hand, and no camera on its arm
    hints = [Severity.HINT] if name in ("place", "view_tag") else []
    assert [finding.severity for finding in found] == hints


def test_pick_before_a_can(tabletop: type[Tabletop]) -> None:
    def example(seed: int) -> Mapping[str, Any]:
        robot = tabletop()
        return {
            "world": ScriptedWorld(robot),
            "services": {"planning_scene": PlanningSceneService()},
            "inputs": {"object": robot.detected()},
        }

    assert check_skill(Pick, example, halts=3) == []


class Holding(PlanningSceneService):
    """A planning scene that knows from its first update what the hand holds."""

    thing: DetectedObject | None = None

    def update(self, robot: Robot, now: float) -> None:
        super().update(robot, now)
        if self.thing is not None:
            self.grasped(self.thing, HAND_FROM_CAN)
            self.holding.last_contact = -math.inf
            self.thing = None


def test_place_with_a_can_in_the_hand(tabletop: type[Tabletop]) -> None:
    def example(seed: int) -> Mapping[str, Any]:
        robot = tabletop(pose="carry")
        scene = Holding()
        scene.thing = robot.detected()
        robot.hold(HAND_FROM_CAN)
        robot.advance(0.05)
        spot = Pose(Transform((0.7, 0.0, 0.72)), "odom", 0.0)
        outline = ((-0.4, -0.7), (0.4, -0.7), (0.4, 0.7), (-0.4, 0.7))
        plane = SupportPlane(Pose(Transform((0.9, 0.0, 0.72)), "odom", 0.0), outline)
        return {
            "world": ScriptedWorld(robot),
            "services": {"planning_scene": scene},
            "inputs": {"plane": plane, "spots": (spot,)},
        }

    assert check_skill(Place, example, halts=3) == []

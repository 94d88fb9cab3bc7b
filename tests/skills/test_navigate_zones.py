"""navigate obeys the site's zones, by the robot's true pose, and says which one forbids what."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from momantu_skills.navigate import Navigate
from momantu_skills.navigation.localize.service import LocalizationService

from momantu_bt.geometry import Pose2D
from momantu_bt.marker import Line
from momantu_bt.testing import ScriptedWorld
from momantu_bt.testing.skill_run import SkillResult, run_skill
from momantu_bt.zone import Zone
from tests.skills.scenery.flat import Flat, FlatSceneOf

DOOR = ((0.3, 0.4), (1.8, 0.4), (1.8, 1.5), (0.3, 1.5))
"""In and around the doorway between the two rooms."""


class Watched:
    """A run in a zoned world: least distance of the true footprint from each zone, and speeds."""

    def __init__(self, world: ScriptedWorld, zones: dict[str, Zone], scene_of: FlatSceneOf) -> None:
        world.site = replace(world.site, zones=zones)
        self.world, self._zones, self._scene_of = world, zones, scene_of
        self.nearest = dict.fromkeys(zones, math.inf)
        self.fastest = dict.fromkeys(zones, 0.0)
        corners = np.array(world.robot.description.footprint)
        sides = zip(corners, np.roll(corners, -1, axis=0), strict=True)
        self._outline = np.concatenate([np.linspace(a, b, 12) for a, b in sides])

    def drive(self, **inputs: Any) -> SkillResult:
        localization = LocalizationService()
        services = {"localization": localization, "planning_scene": self._scene_of(self.world)}
        return run_skill(
            Navigate,
            world=self.world,
            services=services,
            inputs=inputs,
            max_time=150.0,
            on_tick=lambda session, place: self._look(),
        )

    def _look(self) -> None:
        robot: Any = self.world.robot
        c, s = math.cos(robot.truth.yaw), math.sin(robot.truth.yaw)
        outline = self._outline @ np.array([[c, s], [-s, c]]) + (robot.truth.x, robot.truth.y)
        for name, zone in self._zones.items():
            away = float(zone.distance(outline).min())
            self.nearest[name] = min(self.nearest[name], away)
            if away < 0.0:
                self.fastest[name] = max(self.fastest[name], abs(robot.linear))


def test_a_keep_out_zone_on_the_way_is_driven_round(flat: Flat, flat_scene: FlatSceneOf) -> None:
    rug = Zone("keep_out", ((-1.2, -0.6), (0.2, -0.6), (0.2, 0.55), (-1.2, 0.3)))
    run = Watched(flat(), {"rug": rug}, flat_scene)
    result = run.drive(in_front_of="desk")
    assert result.status == "SUCCESS", result.explain()
    assert 0.0 < run.nearest["rug"] < 0.6
    drawn = [each for each in result.markers if each.name == "zone rug"]
    assert isinstance(drawn[0], Line)
    assert (drawn[0].frame, drawn[0].closed) == ("map", True)
    assert drawn[0].points[:, :2].tolist() == [list(corner) for corner in rug.corners]


def test_a_slow_zone_is_crossed_at_its_speed(flat: Flat, flat_scene: FlatSceneOf) -> None:
    run = Watched(flat(), {"door": Zone("slow", DOOR, 0.25)}, flat_scene)
    result = run.drive(in_front_of="desk")
    assert result.status == "SUCCESS", result.explain()
    assert 0.2 < run.fastest["door"] < 0.26


def test_a_goal_in_a_slow_zone_is_reached(flat: Flat, flat_scene: FlatSceneOf) -> None:
    room = Zone("slow", ((1.2, -2.9), (5.9, -2.9), (5.9, 2.9), (1.2, 2.9)), 0.15)
    run = Watched(flat(Pose2D(1.8, -1.5, 1.0)), {"room": room}, flat_scene)
    result = run.drive(in_front_of="desk")
    assert result.status == "SUCCESS", result.explain()
    assert run.fastest["room"] < 0.16


def test_a_start_in_a_keep_out_zone_is_told_and_nothing_moves(
    flat: Flat, flat_scene: FlatSceneOf
) -> None:
    lab = Zone("keep_out", ((-3.0, -1.0), (-1.0, -1.0), (-1.0, 1.0), (-3.0, 1.0)))
    world = flat()
    begin = world.robot.truth
    result = Watched(world, {"lab": lab}, flat_scene).drive(in_front_of="desk")
    assert result.code == "START_KEPT_OUT", result.explain()
    assert "in the keep-out zone lab" in result.failure.message  # type: ignore[union-attr]
    assert world.robot.truth == begin


@pytest.mark.parametrize("goal", [{"goal": Pose2D(3.0, 0.2)}, {"in_front_of": "right"}])
def test_a_goal_in_a_keep_out_zone_is_told_at_once(
    flat: Flat, flat_scene: FlatSceneOf, goal: dict[str, Any]
) -> None:
    lab = Zone("keep_out", ((1.2, -2.9), (5.9, -2.9), (5.9, 2.9), (1.2, 2.9)))
    result = Watched(flat(), {"lab": lab}, flat_scene).drive(**goal)
    assert result.code == "GOAL_KEPT_OUT", result.explain()
    assert "the base would stand in the keep-out zone lab" in result.failure.message  # type: ignore[union-attr]
    assert result.duration < 5.0


def test_zones_that_close_every_way_are_named(flat: Flat, flat_scene: FlatSceneOf) -> None:
    run = Watched(flat(), {"door": Zone("keep_out", DOOR)}, flat_scene)
    result = run.drive(in_front_of="desk", recovery=False)
    assert result.code == "NO_PATH", result.explain()
    assert "keep-out zones close every way to" in result.failure.message  # type: ignore[union-attr]
    assert "zones: door" in result.failure.message  # type: ignore[union-attr]
    assert run.nearest["door"] > 0.0

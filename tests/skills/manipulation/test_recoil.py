"""An arm that meets something goes back, and knows from then on that something is there."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from momantu_skills.manipulation.config import PlanningConfig
from momantu_skills.manipulation.model.arm_model import ArmModel
from momantu_skills.manipulation.motion.recoil import AHEAD, BACK, way_ahead, way_back
from momantu_skills.manipulation.motion.timing import timed

from momantu_bt.failure import Failure
from tests.skills.manipulation.test_motion import run
from tests.skills.manipulation.test_motions import arm_of
from tests.skills.scenery.table import SceneOf, Tabletop


def swing(arm: Any, turn: float = 0.8) -> Any:
    end = arm.joints.copy()
    end[1] += turn
    return timed(arm.group, np.array([arm.joints, end]), PlanningConfig())


class Wall:
    """Stops the shoulder of an arm at an angle, rad, as something in its way does."""

    def __init__(self, robot: Any, at: float) -> None:
        self.robot, self.at, self.dropped = robot, at, set[int]()
        self.obey = robot.command
        robot.command = self.command

    def command(self, actuator: str, goal: Any) -> None:
        if id(goal) not in self.dropped:
            self.obey(actuator, goal)

    def __call__(self) -> None:
        robot = self.robot
        if robot.joints["shoulder_pan_joint"] > self.at:
            robot.joints["shoulder_pan_joint"] = self.at
            self.dropped.update(id(goal) for _, name, goal in robot.commands if name == "arm")
            robot.stop("arm")


def test_it_goes_back_the_way_it_came_and_remembers_what_it_met(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop(pose="carry")
    arm = arm_of(robot, scene_of(robot))
    trajectory, start = swing(arm), arm.joints
    wall = Wall(robot, float(start[1]) + 0.4)
    before = len(arm.scene.surroundings.cells)
    with pytest.raises(Failure) as caught:
        run(arm.follow(trajectory, "moving"), robot, wall)
    assert caught.value.code == "ARM_STUCK"
    assert caught.value.value.data["joint"] == "shoulder_pan_joint"
    back = wall.at - robot.joints["shoulder_pan_joint"]
    assert 0.5 * BACK < back < 1.5 * BACK
    assert len(arm.scene.surroundings.cells) > before
    q = arm.joints
    q[1] = wall.at + AHEAD
    assert arm.scene.world(arm.state, None, 0.0).free(arm.joints)
    assert not arm.scene.world(arm.state, None, 0.0).free(q)


def test_where_a_picture_shows_nothing_there_is_nothing(
    tabletop: type[Tabletop], scene_of: SceneOf, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = tabletop(pose="carry")
    arm = arm_of(robot, scene_of(robot))
    before = arm.scene.surroundings.cells
    shown = lambda points, slack, doubt: np.ones(len(points), dtype=bool)  # noqa: E731
    monkeypatch.setattr(arm.scene.seen_space, "free", shown)
    arm.scene.met(arm.state, arm.joints[None], swing(arm).positions[-1])
    assert arm.scene.surroundings.cells == pytest.approx(before)


def test_an_arm_whose_driver_is_dead_has_met_nothing(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop(pose="carry")
    arm = arm_of(robot, scene_of(robot))
    before = arm.scene.surroundings.cells
    trajectory = swing(arm)
    robot.frozen.add("arm")
    with pytest.raises(Failure, match="ARM_STUCK"):
        run(arm.follow(trajectory, "moving"), robot)
    assert arm.scene.surroundings.cells is before
    assert robot.now() < trajectory.duration + 4.0


def test_the_way_back_and_ahead_lie_on_the_way(model: ArmModel) -> None:
    q = np.zeros(len(model.group.names))
    end = q.copy()
    end[1] = 1.0
    trajectory = timed(model.group, np.array([q, end]), PlanningConfig())
    here = 0.5 * end
    back, ahead = way_back(trajectory, here), way_ahead(trajectory, here)
    assert back[0] == pytest.approx(here)
    assert BACK <= 0.5 - back[-1][1] < BACK + 0.06
    assert AHEAD <= ahead[1] - 0.5 < AHEAD + 0.06
    assert way_back(trajectory, q)[-1] == pytest.approx(q, abs=1e-9)
    assert way_ahead(trajectory, end) == pytest.approx(end)

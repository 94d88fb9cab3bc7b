"""People whom a fault brings: they stand where they say, keep clear, and feel a push."""

from __future__ import annotations

import math

import numpy as np
import pytest
from momantu_worlds.people.walker import BEHIND, STAND, TOO_NEAR
from momantu_worlds.sapien.faults.doorways import doorways_ahead, opening
from momantu_worlds.sapien.faults.person_reaches import DRAWS_BACK
from momantu_worlds.sapien.faults.tops import item_top
from momantu_worlds.scenes.geometry.prisms import body_prism

from momantu_bt.geometry import Pose2D
from momantu_bt.messages import BaseVelocity

FORWARD, BACK = BaseVelocity(0.4, 0.0), BaseVelocity(-0.3, 0.0)


def person(stage):
    (walker,) = stage.crowd.walkers
    return walker


def gap(stage) -> float:
    """Distance between the robot and the person's middle, m."""
    at = np.array([person(stage).at])
    return min(float(prism.base.distance(at)[0]) for prism in stage.robot_prisms())


@pytest.mark.parametrize("seed", [0, 3])
def test_whoever_follows_comes_along_and_makes_room(blind, happening, step, seed):
    stage = blind(seed)
    with happening(stage, "person.follows"):
        begins = person(stage).at
        step(stage, 120, base=FORWARD)
        assert math.dist(begins, person(stage).at) > 0.5
        for _ in range(30):
            step(stage, 1, base=BaseVelocity(0.0, 0.0))
        assert math.dist(person(stage).at, base_at(stage)) < BEHIND + STAND
        step(stage, 40, base=BACK)
        assert gap(stage) > TOO_NEAR / 2
        assert stage.referee.verdict().measures["person_pushed"] == 0.0
    assert stage.crowd.walkers == []


def base_at(stage) -> tuple[float, float]:
    base = stage.base()
    return base.x, base.y


@pytest.mark.parametrize("seed", [0, 3, 6])
def test_somebody_stands_in_the_next_doorway_and_looks_at_the_robot(blind, happening, seed):
    stage = blind(seed)
    first = doorways_ahead(stage)[0]
    with happening(stage, "person.in_doorway"):
        assert math.dist(person(stage).at, opening(stage, first).middle) < 1e-6
        robot = person(stage).pose.inverse() @ stage.base()
        assert abs(math.atan2(robot.y, robot.x)) < 0.01


@pytest.mark.parametrize("seed", [0, 3, 6])
def test_an_arm_ends_before_the_item_and_is_drawn_back_from_the_robot(
    blind, happening, step, stand_before, seed
):
    stage = blind(seed)
    top = item_top(stage)
    with happening(stage, "person.reaches_over"):
        (arm,) = [body for body in stage.simulator.added if body.name.startswith("arm")]
        prism = body_prism(arm, arm.map_from_body)
        assert prism.bottom > top.placed.height
        assert not stage.item_prism().clear_of([prism], 0.3)
        assert stage.item_prism().clear_of([prism], 0.05)
        step(stage, 5)
        assert arm in stage.simulator.added
        x, y = stage.item_pose().position[:2]
        away = math.atan2(person(stage).at[1] - y, person(stage).at[0] - x)
        beside = (x + 0.6 * math.cos(away), y + 0.6 * math.sin(away))
        stage.simulator.robot.carry(Pose2D(*beside, away + math.pi))
        assert not prism.clear_of(stage.robot_prisms(), DRAWS_BACK)
        step(stage, 1)
        assert arm not in stage.simulator.added
        assert stage.crowd.walkers
    assert stage.simulator.added == ()


def test_a_push_against_whom_a_fault_brought_is_told(blind, happening, step):
    stage = blind(3)
    with happening(stage, "person.in_way"):
        step(stage, 80, base=FORWARD)
        verdict = stage.referee.verdict()
    assert verdict.measures["person_pushed"] > 25.0
    assert any(incident.kind == "person" for incident in verdict.incidents)

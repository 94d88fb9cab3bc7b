"""A grasp leaves room below the arm for what may stand beside the object where it is put down."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from momantu_skills.manipulation.arm import Arm
from momantu_skills.manipulation.hand.grasps import Grasp, grasps_for
from momantu_skills.manipulation.hand.placing import plan_place
from momantu_skills.manipulation.hand.reaching import plan_pick
from momantu_skills.manipulation.hand.underside import LOW_PENALTY, low_penalty

from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose, Transform
from momantu_bt.service import HeldObject
from momantu_bt.testing.painting import Block
from tests.skills.manipulation.test_motions import arm_of
from tests.skills.scenery.table import TABLE, SceneOf, Tabletop

LOW = 0.06
"""m; height of the things between which the can is put down: half of its own."""


@pytest.fixture
def picked(tabletop: type[Tabletop], scene_of: SceneOf) -> tuple[Arm, HeldObject, np.ndarray]:
    """The arm before the can, the can in the hand as its best grasp has it, and that posture."""
    robot = tabletop()
    arm = arm_of(robot, scene_of(robot))
    thing = robot.detected()
    arm.scene.support_below(thing)
    plan = plan_pick(arm, thing, 0.12)
    held = HeldObject(thing, plan.grasp.object_from_grasp.inverse())
    return arm, held, plan.approach.positions[-1]


def test_the_best_grasp_is_not_one_that_lies_on_the_table(
    picked: tuple[Arm, HeldObject, np.ndarray],
) -> None:
    arm, held, q = picked
    tilt = -float(held.grasp_from_object.inverse().rotation[2, 0])
    assert tilt > 0.2
    assert low_penalty(arm, held.object, q) < 0.7 * LOW_PENALTY


@pytest.mark.parametrize("height", [0.01, 0.03, 0.06, 0.2])
def test_the_higher_the_arm_the_lower_the_cost(
    picked: tuple[Arm, HeldObject, np.ndarray], height: float
) -> None:
    arm, held, q = picked
    usual = low_penalty(arm, held.object, q)
    assert 0.0 <= usual <= LOW_PENALTY
    below = replace(held.object.pose, transform=Transform((0.75, 0.0, TABLE + 0.065 - height)))
    cost = low_penalty(arm, replace(held.object, pose=below), q)
    assert cost == pytest.approx(max(0.0, usual - LOW_PENALTY * height / 0.13), abs=1e-6)


@pytest.mark.parametrize("tilt", [0, 30])
def test_only_a_hand_that_leans_puts_down_between_low_things(
    tabletop: type[Tabletop], scene_of: SceneOf, tilt: int
) -> None:
    robot = tabletop()
    thing = robot.detected()
    robot.can = None
    grid = [(0.7 + 0.16 * i, 0.16 * j) for i in range(-1, 3) for j in range(-2, 3)]
    robot.others = [
        Block((0.09, 0.09, LOW), (x, y, TABLE + LOW / 2)) for x, y in grid if (x, y) != (0.7, 0.0)
    ]
    arm = arm_of(robot, scene_of(robot))
    arm.scene.support_below(thing)
    model = arm.scene.model
    grasps = grasps_for(thing, model.description.hand, model.palm, model.open_fingers)
    grasp = next(g for g in grasps if round(_tilt(g)) == tilt)
    held = HeldObject(thing, grasp.object_from_grasp.inverse())
    spot = Pose(Transform((0.7, 0.0, TABLE)), "odom", 0.0)
    if tilt:
        plan = plan_place(arm, held, [spot])
        assert plan.odom_from_object.position[:2] == pytest.approx(spot.position[:2], abs=1e-6)
    else:
        with pytest.raises(Failure, match="none of 1 spots"):
            plan_place(arm, held, [spot])


def _tilt(grasp: Grasp) -> float:
    """Angle of the fingers below the horizontal, degrees."""
    return math.degrees(math.asin(float(np.clip(-grasp.object_from_grasp.rotation[2, 0], -1, 1))))

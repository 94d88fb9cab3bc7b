"""Fold an extended arm before the base drives."""

from __future__ import annotations

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.robot import Robot
from momantu_bt.skill import Run, Skill
from momantu_skills.gaze.unseen_ways import routed_in_sight
from momantu_skills.manipulation.arm import Arm
from momantu_skills.manipulation.scene.arm_scene import ArmScene
from momantu_skills.manipulation.scene.surroundings import within

STICKS_OUT = 0.10
"""How far arm and held object may extend beyond the base's outline while driving, m."""
THERE = 0.02
"""Distance from its pose at which the arm counts as folded, rad or m."""
THINKING = 0.2
"""Time allowed for planning, s: several times its median."""
NO_WAY = ("NO_PLAN", "START_IN_COLLISION")


def take_in(skill: Skill, robot: Robot, service: ArmScene) -> Run:
    """Fold an arm that extends beyond the base into `home`, or `carry` if it holds an object.

    It looks first where its way leads over a surface that no picture has shown; the skill uses
    CAMERA_CARRIER. Where it finds no way, the base drives with the arm as it is: that may be what
    gives it room.

    Raises:
        Failure: ARM_STUCK.
    """
    arm = Arm(skill, robot, service)
    base = np.array(robot.description.footprint)
    if within(service.footprint(arm.state), base, STICKS_OUT).all():
        return
    held = service.held
    goal = arm.posed(robot.description.named_poses["home" if held is None else "carry"])
    if np.abs(goal - arm.joints).max() < THERE:
        return
    yield from arm.settle()
    arm.observe()
    try:
        way = yield from routed_in_sight(arm, goal, THINKING)
    except Failure as failure:
        if failure.code not in NO_WAY:
            raise
        return
    for trajectory in way:
        yield from arm.follow(trajectory, "taking the arm in")

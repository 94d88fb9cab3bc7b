"""Folding an arm that was stretched out to look, before the base drives."""

from __future__ import annotations

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.robot import Robot
from momantu_bt.skill import Run, Skill, compute
from momantu_skills.manipulation.arm import Arm
from momantu_skills.manipulation.scene.arm_scene import ArmScene
from momantu_skills.manipulation.scene.surroundings import within

STICKS_OUT = 0.10
"""m beyond the base's outline that arm and load may reach on the way."""
THERE = 0.02
"""rad or m from its pose at which the arm is in."""
THINKING = 0.2
"""s that planning is given: several times its median."""
NO_WAY = ("NO_PLAN", "START_IN_COLLISION")


def take_in(skill: Skill, robot: Robot, service: ArmScene) -> Run:
    """Fold an arm that reaches beyond the base, into `home`, or `carry` with what it holds.

    Where it finds no way, the base drives with the arm as it is: that may be what gives it room.

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
        way = yield from compute(lambda: arm.route([goal], held), THINKING)
    except Failure as failure:
        if failure.code not in NO_WAY:
            raise
        return
    for trajectory in way:
        yield from arm.follow(trajectory, "taking the arm in")

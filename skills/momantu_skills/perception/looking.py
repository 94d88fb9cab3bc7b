"""Pointing the camera at a place and waiting until the picture is still."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from momantu_bt.failure import Failure
from momantu_bt.frames import ODOM
from momantu_bt.messages import JointPositions, RobotState
from momantu_bt.robot import CAMERA_CARRIER, Robot, RobotDescription
from momantu_bt.skill import Run, Skill
from momantu_skills.perception.aiming import aim

WITHIN = 0.10
"""rad off the optical axis that still counts as looking at a point: a tenth of most views."""
ARRIVED = 0.01
"""rad (or m) between a joint and its goal: above measurement and control error."""
STILL = 0.02
"""rad/s and m/s below which a picture is not blurred, above the noise of reported speeds."""
PATIENCE = 1.5
"""s beyond twice the fastest travel after which the camera counts as stuck."""
HEAD_JOINTS = 3
"""A carrier of more joints is an arm: its way must be planned, which pointing does not do."""


def look_at(skill: Skill, robot: Robot, point_odom: ArrayLike, *, within: float = WITHIN) -> Run:
    """Point the robot's first camera at `point_odom` (3,), m, and wait until joints and base rest.

    The calling skill declares CAMERA_CARRIER in `uses` and OUT_OF_VIEW in `failures`. Usage:
    `yield from look_at(self, robot, point)`. within: rad off the axis that is good enough; pi
    takes whatever the limits allow.

    Raises:
        Failure: OUT_OF_VIEW when the limits forbid it, when the camera does not get there in
            time, or when it is carried by an arm.
    """
    description = robot.description
    carrier = description.resolve_use(CAMERA_CARRIER)
    goal = _goal(skill, robot, carrier, np.asarray(point_odom, dtype=np.float64), within)
    deadline = skill.clock.now() + 2.0 * _travel(description, robot.state(), goal) + PATIENCE
    while not (_arrived(robot.state(), goal) and _still(robot.state(), goal)):
        if skill.clock.now() > deadline:
            if _arrived(robot.state(), goal):
                return
            raise Failure(
                "OUT_OF_VIEW",
                f"the camera's carrier {carrier} did not reach its goal in time: is it stuck?",
                goal=list(goal.positions),
                reached=[robot.state().position(j) for j in goal.names],
            )
        robot.command(carrier, goal)
        yield "look"


def _goal(
    skill: Skill, robot: Robot, carrier: str, point_odom: np.ndarray, within: float
) -> JointPositions:
    description = robot.description
    joints = description.actuators[carrier].joints
    if len(joints) > HEAD_JOINTS:
        raise Failure(
            "OUT_OF_VIEW",
            f"the camera is carried by {carrier}, an arm of {len(joints)} joints; give it a named "
            "pose that looks there (reset_pose), for pointing does not plan around obstacles",
            carrier=carrier,
        )
    point_base = skill.frames.lookup(description.base_frame, ODOM).apply(point_odom)
    aimed = aim(
        skill.frames.kinematics,
        description.camera()[1].frame,
        joints,
        description.joint_limits,
        robot.state().joints(),
        point_base,
    )
    if aimed.off_axis > within:
        raise Failure(
            "OUT_OF_VIEW",
            f"the limits of {', '.join(joints)} keep the camera {math.degrees(aimed.off_axis):.0f} "
            f"degrees from the point ({point_base[0]:.2f}, {point_base[1]:.2f}, "
            f"{point_base[2]:.2f}) m in the base frame; turn the robot towards it",
            off_axis=aimed.off_axis,
        )
    return JointPositions(joints, aimed.positions)


def _travel(description: RobotDescription, state: RobotState, goal: JointPositions) -> float:
    """Seconds that the slowest joint needs, its acceleration included."""
    seconds = 0.0
    for name, target in zip(goal.names, goal.positions, strict=True):
        limit = description.joint_limits[name]
        ramp = limit.velocity / limit.acceleration
        seconds = max(seconds, abs(target - state.position(name)) / limit.velocity + ramp)
    return seconds


def _arrived(state: RobotState, goal: JointPositions) -> bool:
    pairs = zip(goal.names, goal.positions, strict=True)
    return all(abs(state.position(name) - target) <= ARRIVED for name, target in pairs)


def _still(state: RobotState, goal: JointPositions) -> bool:
    speeds = (float(state.velocities[state.names.index(name)]) for name in goal.names)
    base = (state.linear, state.angular)
    return all(abs(speed) <= STILL for speed in (*speeds, *base))

"""Pointing the camera at a point and waiting until the picture is still."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from momantu_bt.failure import Failure
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Array
from momantu_bt.lazy import lazily
from momantu_bt.messages import JointPositions, RobotState
from momantu_bt.robot import CAMERA_CARRIER, Robot, RobotDescription
from momantu_bt.skill import Run, Skill
from momantu_skills.perception.camera.aiming import aim, view_error

with lazily():
    from momantu_skills.gaze import arm_camera


WITHIN = 0.10
"""Angle off the optical axis that still counts as looking at a point, rad: a tenth of most
views."""
ARRIVED = 0.01
"""Largest distance between a joint and its goal, rad (or m): above measurement and control
error."""
STILL = 0.02
"""Speed below which a picture is not blurred, rad/s and m/s; above the noise of reported speeds."""
PATIENCE = 1.5
"""The camera counts as stuck after twice the fastest motion plus this, s."""


def look_at(
    skill: Skill,
    robot: Robot,
    point_odom: ArrayLike,
    *,
    within: float = WITHIN,
    around: Sequence[Array] = (),
) -> Run:
    """Point the first camera at `point_odom` (3,), m, and wait until it is still.

    A head is turned. An arm that carries the camera moves to where the camera sees the point past
    the held object. With a fixed camera the point is either in view or not. The calling skill
    declares CAMERA_CARRIER in `uses`, needs the planning scene, and has OUT_OF_VIEW among its
    `failures`. Usage: `yield from look_at(self, robot, point)`. within: largest angle off the axis,
    rad. around: corners (n, 3) in odom of solids that an arm avoids, in addition to known ones.

    Raises:
        Failure: OUT_OF_VIEW if the joint limits forbid it, if the camera does not arrive in
            time, or if no path for its arm was found.
    """
    point = np.asarray(point_odom, dtype=np.float64)
    carrier = robot.description.resolve_use(CAMERA_CARRIER)
    if robot.description.eye_in_hand:
        yield from _reach_out(skill, robot, point, within, around)
    elif carrier is not None:
        yield from _turn(skill, robot, carrier, point, within)
    else:
        yield from _wait(skill, robot, point, within)


def _reach_out(
    skill: Skill, robot: Robot, point: Array, within: float, around: Sequence[Array]
) -> Run:
    """Move the arm; the planner is imported here, as robots with a head do not need one to look."""
    yield from arm_camera.gaze(
        skill, robot, skill.services["planning_scene"], point, within, around
    )


def _turn(skill: Skill, robot: Robot, carrier: str, point: Array, within: float) -> Run:
    """Turn the joints of a head, which cannot hit an obstacle."""
    description = robot.description
    goal = _goal(skill, robot, carrier, point, within)
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


def _wait(skill: Skill, robot: Robot, point_odom: Array, within: float) -> Run:
    """Wait until the base rests; then check whether the fixed camera sees the point."""
    deadline = skill.clock.now() + PATIENCE
    while not _base_still(robot.state()) and skill.clock.now() < deadline:
        yield "look"
    frame = robot.description.camera()[1].frame
    off = float(np.hypot(*view_error(skill.frames.lookup(frame, ODOM).apply(point_odom))))
    if off > within:
        raise Failure(
            "OUT_OF_VIEW",
            f"the camera is fixed, and the point lies {math.degrees(off):.0f} degrees off its "
            "axis; turn the robot towards it",
            off_axis=off,
        )


def _goal(
    skill: Skill, robot: Robot, carrier: str, point_odom: Array, within: float
) -> JointPositions:
    description = robot.description
    joints = description.actuators[carrier].joints
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
    return _base_still(state) and all(abs(speed) <= STILL for speed in speeds)


def _base_still(state: RobotState) -> bool:
    return all(abs(speed) <= STILL for speed in (state.linear, state.angular, state.lateral))

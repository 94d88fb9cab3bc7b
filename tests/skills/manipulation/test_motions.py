"""Motions of pick and place: exact at the object, straight, within limits, touching nothing."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.manipulation.arm import Arm, straight_line
from momantu_skills.manipulation.config import PlanningConfig
from momantu_skills.manipulation.hand.gripper import MOVEMENT, move_gripper, open_hand
from momantu_skills.manipulation.hand.placing import plan_place
from momantu_skills.manipulation.hand.reaching import plan_pick
from momantu_skills.manipulation.model.arm_model import ArmModel
from momantu_skills.manipulation.motion.following import ARRIVED
from momantu_skills.manipulation.motion.timing import timed
from momantu_skills.perception.camera.snapshot import take

from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose, Transform
from momantu_bt.messages import JointTrajectory
from momantu_bt.service import HeldObject
from tests.skills.scenery.table import SceneOf, Tabletop

LIFT = 0.12
EXACT = 1.5e-3
"""m: twice what inverse kinematics solves to, and the spline between its solutions."""


def arm_of(robot: Any, scene: Any) -> Arm:
    """An arm as a skill has it, its surroundings seen."""
    scene.frames.add_state(robot.state())
    scene.observe(take(robot, scene.frames))
    skill = SimpleNamespace(random=np.random.default_rng(0), clock=robot)
    return Arm(skill, robot, scene)  # type: ignore[arg-type]


def grasp_at(arm: Arm, q: np.ndarray) -> Transform:
    """odom_from_grasp at joints (n,)."""
    base = arm.state.odom_from_base
    return base @ arm.group.tip_pose(q) @ arm.scene.model.tip_from_grasp


def check_joined(arm: Arm, start: np.ndarray, pieces: list[JointTrajectory]) -> None:
    """Each piece begins where the one before ended, within limits of position and speed."""
    for piece in pieces:
        assert np.abs(piece.positions[0] - start).max() < ARRIVED / 4
        assert (piece.positions >= arm.group.lower).all()
        assert (piece.positions <= arm.group.upper).all()
        assert (np.abs(piece.velocities) <= arm.group.velocity * 1.001).all()
        assert not piece.velocities[[0, -1]].any()
        start = piece.positions[-1]


def straightness(arm: Arm, piece: JointTrajectory) -> float:
    """Greatest distance of the grasp point to the line between its ends, m."""
    points = np.array([grasp_at(arm, q).position for q in piece.positions])
    way = points[-1] - points[0]
    across = np.cross(points - points[0], way / np.linalg.norm(way))
    return float(np.linalg.norm(across, axis=1).max())


@pytest.mark.parametrize("can", [(0.75, 0.0), (0.65, 0.25), (0.85, -0.2)])
def test_a_pick_is_exact_straight_and_joined(
    tabletop: type[Tabletop], scene_of: SceneOf, can: Any
) -> None:
    robot = tabletop(can)
    arm = arm_of(robot, scene_of(robot))
    thing = robot.detected()
    arm.scene.support_below(thing)
    start = arm.joints
    plan = plan_pick(arm, thing, LIFT)
    check_joined(arm, start, [*plan.transit, plan.approach, plan.lift])
    check_joined(arm, plan.approach.positions[-1], [plan.retreat])
    asked = thing.pose.transform @ plan.grasp.object_from_grasp
    for q in (plan.approach.positions[-1], plan.lift.positions[0]):
        there = grasp_at(arm, q)
        assert np.linalg.norm(there.position - asked.position) < EXACT
        assert there.angle_to(asked) < 0.01
    before = grasp_at(arm, plan.approach.positions[0])
    back = asked.inverse().apply(before.position)
    assert back == pytest.approx((-arm.hand.approach, 0.0, 0.0), abs=2 * EXACT)
    above = grasp_at(arm, plan.lift.positions[-1])
    assert above.position - asked.position == pytest.approx((0.0, 0.0, LIFT), abs=2 * EXACT)
    for piece in (plan.approach, plan.retreat, plan.lift):
        assert straightness(arm, piece) < 0.004
    world = arm.scene.world(arm.state, None, 0.0, width=arm.open_width)
    for piece in plan.transit:
        assert world.path_free(piece.positions)


@pytest.mark.parametrize("yaw", [0.0, 2.0])
def test_a_place_is_upright_above_its_spot_and_lowers_straight_down(
    tabletop: type[Tabletop], scene_of: SceneOf, yaw: float
) -> None:
    robot = tabletop(pose="carry")
    robot.hold(Transform())
    scene = scene_of(robot)
    arm = arm_of(robot, scene)
    held = HeldObject(robot.detected(), Transform())
    scene.holding.claim(held, 0.07, 0.0)
    turn = (math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2))
    spot = Pose(Transform((0.75, 0.1, 0.72), turn), "odom", 0.0)
    start = arm.joints
    plan = plan_place(arm, held, [spot])
    check_joined(arm, start, [*plan.transit, plan.lower])
    place = plan.odom_from_object
    assert place.position == pytest.approx((0.75, 0.1, 0.72 + 0.065))
    assert place.rotation[2, 2] == pytest.approx(1.0)
    first, last = (grasp_at(arm, plan.lower.positions[i]) for i in (0, -1))
    up = np.array([0.0, 0.0, 1.0])
    asked = place @ held.grasp_from_object.inverse()
    assert first.position == pytest.approx(asked.position + arm.hand.above * up, abs=EXACT)
    assert last.position == pytest.approx(asked.position - arm.hand.below * up, abs=2 * EXACT)
    for q in plan.lower.positions:
        assert arm.lean(held, q) < 0.01
    assert straightness(arm, plan.lower) < 0.004
    duration = (arm.hand.above + arm.hand.below) / arm.hand.lower_speed
    assert plan.lower.duration > 0.99 * duration


@given(st.integers(0, 500), st.floats(0.005, 0.05))
def test_a_straight_line_is_straight_in_small_even_steps(seed: int, step: float) -> None:
    random = np.random.default_rng(seed)
    first = Transform(random.uniform(-1, 1, 3), random.normal(size=4))
    last = Transform(random.uniform(-1, 1, 3), random.normal(size=4))
    poses = straight_line(first.matrix, last.matrix, step)
    assert poses[-1] == pytest.approx(last.matrix, abs=1e-6)
    points = np.vstack([first.position, poses[:, :3, 3]])
    gaps = np.diff(points, axis=0)
    assert np.ptp(gaps, axis=0) == pytest.approx(np.zeros(3), abs=1e-9)
    assert np.linalg.norm(gaps, axis=1).max() <= step + 1e-9
    turns = [Transform.from_matrix(pose) for pose in (first.matrix, *poses)]
    between = [first.angle_to(turn) + turn.angle_to(last) for turn in turns]
    assert max(between) <= first.angle_to(last) + 1e-4


@pytest.mark.parametrize("rounding", [None, 0.5, 0.1])
def test_a_spline_that_turns_beside_a_limit_stays_inside(
    model: ArmModel, rounding: float | None
) -> None:
    group, random = model.group, np.random.default_rng(0)
    lower = np.where(group.endless, -np.pi, group.lower)
    upper = np.where(group.endless, np.pi, group.upper)
    for joint in np.flatnonzero(~group.endless):
        path = random.uniform(lower, upper, (3, len(lower)))
        path[1, joint] = upper[joint]
        trajectory = timed(group, path, PlanningConfig(), rounding=rounding)
        assert (trajectory.positions <= group.upper).all()
        assert (trajectory.positions >= group.lower).all()


def test_the_way_back_leads_to_the_start_from_wherever_it_was_left(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop(pose="carry")
    arm = arm_of(robot, scene_of(robot))
    start = arm.joints
    path = np.array([start, start + 0.05, start + 0.2])
    trajectory = timed(arm.group, path, arm.planning)
    for share in (0.0, 0.4, 1.0):
        left = trajectory.positions[round(share * (len(trajectory.positions) - 1))]
        for name, value in zip(arm.group.names, left, strict=True):
            robot.joints[name] = float(value)
        back = arm.reversed(trajectory)
        assert back.positions[0] == pytest.approx(arm.joints, abs=1e-6)
        assert back.positions[-1] == pytest.approx(start, abs=1e-3)
        furthest = np.abs(back.positions - start).max()
        assert furthest <= np.abs(left - start).max() + 0.01


@pytest.mark.parametrize("jammed_at", [0.0, 0.03, 0.08])
def test_fingers_that_do_not_open_are_stuck_in_bounded_time(
    tabletop: type[Tabletop], jammed_at: float
) -> None:
    robot = tabletop(can=None)
    robot.gripper_width = jammed_at
    robot.frozen.add("gripper")
    ticks = (robot.advance(0.05) for _ in open_hand(robot, robot, 0.1, 45.0, 3.0))
    with pytest.raises(Failure) as caught:
        list(ticks)
    assert caught.value.code == "GRIPPER_STUCK"
    assert f"{jammed_at * 1000:.0f} mm of 100 mm" in str(caught.value)
    assert robot.now() < 3.2


@pytest.mark.parametrize("thing", [0.02, 0.05, 0.09])
def test_closing_ends_on_things_of_any_width(tabletop: type[Tabletop], thing: float) -> None:
    robot = tabletop(can=None)
    robot.gripper_width, robot.object_width = 0.1, thing
    closing = move_gripper(robot, robot, 0.0, 45.0, 3.0, "closing")
    reached = None
    while reached is None:
        try:
            next(closing)
            robot.advance(0.05)
        except StopIteration as end:
            reached = end.value
    assert reached == pytest.approx(thing, abs=MOVEMENT)
    assert robot.now() < 2.0

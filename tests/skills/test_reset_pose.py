"""reset_pose: ends in the named pose around what stands there, or says why not."""

from __future__ import annotations

from itertools import permutations
from typing import Any

import numpy as np
import pytest
from momantu_skills.manipulation.config import PlanningConfig
from momantu_skills.manipulation.motion import planner
from momantu_skills.manipulation.scene.scene import Scene
from momantu_skills.reset_pose import ResetPose

from momantu_bt.claim import JointsAt
from momantu_bt.geometry import Transform
from momantu_bt.messages import JointTrajectory
from momantu_bt.testing import ScriptedRobot, run_skill
from momantu_bt.testing.painting import Block, Painter
from tests.skills.scenery.table import SceneOf, Tabletop

STRETCHED = {
    "torso_lift_joint": 0.3,
    "shoulder_pan_joint": -0.9,
    "shoulder_lift_joint": 0.4,
    "upperarm_roll_joint": 0.0,
    "elbow_flex_joint": 0.8,
    "forearm_roll_joint": 0.0,
    "wrist_flex_joint": 0.8,
    "wrist_roll_joint": 0.0,
}
"""The arm reaching out to the robot's right."""
POSES = ("home", "ready", "carry", "look_around")


def reset(robot: Any, scene: Any, pose: str, **more: Any) -> Any:
    return run_skill(
        ResetPose,
        robot=robot,
        inputs={"pose": pose},
        services={"planning_scene": scene},
        frames=scene.frames,
        **more,
    )


def off(robot: ScriptedRobot, pose: str) -> float:
    wanted = robot.description.named_poses[pose]
    return max(abs(robot.joints[name] - value) for name, value in wanted.items())


@pytest.mark.parametrize(("start", "end"), list(permutations(POSES, 2)))
def test_every_pose_is_reached_from_every_other(
    tabletop: type[Tabletop], scene_of: SceneOf, start: str, end: str
) -> None:
    robot = tabletop(can=None, pose=start)
    robot.readings["head_camera"] = Painter([])
    result = reset(robot, scene_of(robot), end)
    assert result.status == "SUCCESS", result.explain()
    assert off(robot, end) < 0.02
    assert result.duration < 8.0


def test_being_there_takes_no_motion(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop(pose="home")
    result = reset(robot, scene_of(robot), "home")
    assert result.status == "SUCCESS", result.explain()
    assert not any(actuator == "arm" and goal is not None for _, actuator, goal in robot.commands)


def test_joints_that_a_pose_does_not_name_stay(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop(can=None, pose="ready")
    description = robot.description.model_copy(
        update={"named_poses": {**robot.description.named_poses, "low": {"torso_lift_joint": 0.25}}}
    )
    robot._description = description
    before = dict(robot.joints)
    result = reset(robot, scene_of(robot), "low")
    assert result.status == "SUCCESS", result.explain()
    moved = {name for name in before if abs(robot.joints[name] - before[name]) > 0.005}
    assert moved == {"torso_lift_joint"}


def test_turns_of_an_endless_joint_are_not_unwound(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop(can=None, pose="ready")
    robot.joints["wrist_roll_joint"] += 4 * np.pi
    result = reset(robot, scene_of(robot), "carry")
    assert result.status == "SUCCESS", result.explain()
    carried = robot.description.named_poses["carry"]["wrist_roll_joint"]
    assert abs(robot.joints["wrist_roll_joint"] - carried - 4 * np.pi) < 2 * np.pi + 0.02
    assert result.duration < 6.0


def test_a_pillar_in_the_way_is_gone_around(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    """From before the robot's right side to its left, past a pillar in the middle."""
    robot = tabletop(can=None, pose="carry")
    robot.joints |= STRETCHED
    robot.joints["head_tilt_joint"] = 0.5
    low, high = np.array([0.55, -0.05, 0.0]), np.array([0.65, 0.05, 1.3])
    pillar = Block(tuple(high - low), tuple((low + high) / 2))
    robot.readings["head_camera"] = Painter([pillar])
    scene = scene_of(robot)
    touched: list[bool] = []

    def watch(session: Any, world: Any) -> None:
        model = scene.scene.model
        poses = model.link_poses(model.configuration(robot.state()))
        points = [hull @ poses[k][:3, :3].T + poses[k][:3, 3] for k, hull in model.hulls.items()]
        corners = np.vstack(points)
        touched.append(bool(((corners > low) & (corners < high)).all(axis=1).any()))

    result = reset(robot, scene, "carry", on_tick=watch)
    assert result.status == "SUCCESS", result.explain()
    assert touched
    assert not any(touched)


def test_what_is_held_stays_held(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop(pose="carry")
    thing = robot.detected()
    robot.hold(Transform((0.007, 0.0, 0.0)))
    robot.advance(0.05)
    robot.joints["torso_lift_joint"] = 0.2
    scene = scene_of(robot)
    scene.grasped(thing, Transform((0.007, 0.0, 0.0)))
    result = reset(robot, scene, "carry")
    assert result.status == "SUCCESS", result.explain()
    assert scene.held is not None
    assert not any(actuator == "gripper" for time, actuator, _ in robot.commands if time > 0.06)


@pytest.mark.parametrize(
    ("pose", "hint"), [("hone", "; did you mean 'home'"), ("zzz", "")], ids=["near", "far"]
)
def test_unknown_pose(tabletop: type[Tabletop], scene_of: SceneOf, pose: str, hint: str) -> None:
    robot = tabletop()
    result = reset(robot, scene_of(robot), pose)
    assert result.code == "UNKNOWN_POSE"
    poses = ", ".join(robot.description.named_poses)
    assert result.failure.message == f"fetch has no pose {pose!r}{hint}; its poses: {poses}"


def test_a_pose_inside_something_is_no_plan(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop(can=None, pose="ready")
    robot.joints["head_tilt_joint"] = 1.1
    robot.readings["head_camera"] = Painter([Block((0.3, 0.4, 0.3), (0.5, -0.2, 0.9))])
    result = reset(robot, scene_of(robot), "carry")
    assert result.code == "NO_PLAN"
    assert "cells" in result.failure.message


def test_a_start_within_the_margin_is_left(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop(can=None, pose="carry")
    hand = robot.odom_from_hand.position
    top = hand[2] - 0.075
    robot.readings["head_camera"] = Painter([Block((0.2, 0.3, top), (hand[0], hand[1], top / 2))])
    result = reset(robot, scene_of(robot), "home")
    assert result.status == "SUCCESS", result.explain()


def test_a_start_that_only_the_wide_margin_encloses_is_left_with_the_narrow_one(
    tabletop: type[Tabletop], scene_of: SceneOf, monkeypatch: pytest.MonkeyPatch
) -> None:
    wide, original = PlanningConfig().margins[0], Scene.world

    def world(self: Scene, state: Any, held: Any, margin: float, **more: Any) -> Any:
        made = original(self, state, held, margin, **more)
        if margin == wide:
            monkeypatch.setattr(made, "free", lambda *_: False)
        return made

    monkeypatch.setattr(Scene, "world", world)
    monkeypatch.setattr(planner, "escape", lambda *_: None)
    robot = tabletop(can=None, pose="carry")
    result = reset(robot, scene_of(robot), "home")
    assert result.status == "SUCCESS", result.explain()


def test_a_start_deep_in_something_is_reported(
    tabletop: type[Tabletop], scene_of: SceneOf, monkeypatch: pytest.MonkeyPatch
) -> None:
    from momantu_skills.manipulation.model.collision import CollisionWorld

    robot = tabletop(can=None, pose="carry")
    monkeypatch.setattr(CollisionWorld, "free", lambda *_: False)
    result = reset(robot, scene_of(robot), "home")
    assert result.code == "START_IN_COLLISION"


def test_an_arm_that_does_not_move_is_stuck(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop(can=None, pose="carry")
    robot.frozen.add("arm")
    result = reset(robot, scene_of(robot), "home")
    assert result.code == "ARM_STUCK"
    assert result.duration < 5.0


def test_the_same_seed_gives_the_same_trajectory(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    sent = []
    for _ in range(2):
        robot = tabletop(can=None, pose="carry")
        robot.joints |= STRETCHED
        reset(robot, scene_of(robot), "home", seed=5)
        goals = [goal for _, _, goal in robot.commands if isinstance(goal, JointTrajectory)]
        sent.append(b"".join(goal.positions.tobytes() for goal in goals))
    assert sent[0] == sent[1]
    assert sent[0]


@pytest.mark.parametrize("stuck", [False, True])
def test_arm_and_camera_are_claimed_in_the_pose_whether_said_or_denied(
    tabletop: type[Tabletop], scene_of: SceneOf, stuck: bool
) -> None:
    robot = tabletop(can=None, pose="carry")
    robot.frozen |= {"arm"} if stuck else set()
    result = reset(robot, scene_of(robot), "home")
    claim = result.claim()
    assert (result.code == "ARM_STUCK") is stuck
    assert isinstance(claim, JointsAt)
    wanted = dict(zip(claim.names, claim.positions, strict=True))
    assert wanted == robot.description.named_poses["home"]
    there = all(abs(robot.joints[n] - p) <= claim.tolerance for n, p in wanted.items())
    assert there is not stuck


def test_a_pose_that_is_not_known_claims_nothing(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop()
    assert reset(robot, scene_of(robot), "hone").claim() is None

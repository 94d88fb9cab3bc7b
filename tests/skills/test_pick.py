"""pick: one run that succeeds, and one for each way in which it can fail."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from momantu_skills.manipulation.arm import Arm
from momantu_skills.pick import Pick

from momantu_bt.claim import Holding, ObjectAt
from momantu_bt.messages import DetectedObject, JointTrajectory, ObjectClass
from momantu_bt.testing import run_skill
from momantu_bt.testing.painting import Block
from tests.skills.scenery.table import SceneOf, Tabletop


def pick(robot: Any, scene: Any, thing: DetectedObject, **more: Any) -> Any:
    return run_skill(
        Pick,
        robot=robot,
        inputs={"object": thing},
        services={"planning_scene": scene},
        frames=scene.frames,
        **more,
    )


def test_the_can_is_lifted_and_known_to_be_held(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop()
    before = robot.can
    scene = scene_of(robot)
    result = pick(robot, scene, robot.detected())
    assert result.status == "SUCCESS", result.explain()
    assert robot.can.position[2] - before.position[2] == pytest.approx(0.12, abs=0.01)
    assert np.linalg.norm((robot.can.position - before.position)[:2]) < 0.01
    assert scene.held is not None
    believed = robot.odom_from_hand @ scene.held.grasp_from_object
    assert np.linalg.norm(believed.position - robot.can.position) < 0.01
    assert scene.last_contact > 0.0
    joints = scene.scene.model.joints(robot.state())
    assert scene.scene.world(robot.state(), scene.held, 0.012).touching(joints) == []


def test_a_grasp_that_is_cut_off_while_the_fingers_close_is_known(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot, since = tabletop(), list[float]()

    def note(session: Any, world: Any) -> None:
        if robot.hand_from_can is not None:
            since.append(robot.time)

    assert pick(robot, scene_of(robot), robot.detected(), on_tick=note).status == "SUCCESS"
    robot = tabletop()
    scene = scene_of(robot)
    result = pick(robot, scene, robot.detected(), max_time=since[0])
    assert result.status == "HALTED"
    for _ in range(10):
        robot.advance(0.05)
        scene.update(robot, robot.time)
    assert scene.held is not None
    believed = robot.odom_from_hand @ scene.held.grasp_from_object
    assert np.linalg.norm(believed.position - robot.can.position) < 0.01


@pytest.mark.parametrize("can", [(0.65, 0.2), (0.9, -0.2)])
def test_the_same_seed_moves_the_same_way(
    tabletop: type[Tabletop], scene_of: SceneOf, can: Any
) -> None:
    goals = []
    for _ in range(2):
        robot = tabletop(can)
        result = pick(robot, scene_of(robot), robot.detected(), seed=3)
        assert result.status == "SUCCESS", result.explain()
        sent = [goal for _, _, goal in robot.commands if isinstance(goal, JointTrajectory)]
        goals.append([goal.positions.tobytes() for goal in sent])
    assert goals[0] == goals[1]


def test_a_neighbour_is_not_touched(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop((0.75, 0.0))
    robot.others = [Block((0.06, 0.06, 0.2), (0.75, 0.14, robot.table + 0.1))]
    low, high = np.array([0.72, 0.11, 0.72]), np.array([0.78, 0.17, 0.92])
    scene = scene_of(robot)
    seen: list[bool] = []

    def watch(session: Any, world: Any) -> None:
        poses = scene.scene.model.link_poses(scene.scene.model.configuration(robot.state()))
        hand = [link for link in poses if "gripper" in link or "wrist" in link]
        points = [scene.scene.model.hulls[k] @ poses[k][:3, :3].T + poses[k][:3, 3] for k in hand]
        corners = np.vstack(points)
        seen.append(bool(((corners > low) & (corners < high)).all(axis=1).any()))

    result = pick(robot, scene, robot.detected(), on_tick=watch)
    assert result.status == "SUCCESS", result.explain()
    assert seen
    assert not any(seen)


def test_nothing_there(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop()
    thing = robot.detected()
    robot.can = None
    assert pick(robot, scene_of(robot), thing).code == "NOTHING_THERE"


def test_an_old_pose_is_stale(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop()
    result = pick(robot, scene_of(robot), robot.detected(stamp=-100.0))
    assert result.code == "STALE_POSE"
    assert "100 s ago" in result.failure.message


def test_a_pose_from_before_the_last_contact_is_stale(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop()
    thing = robot.detected()
    robot.time = 1.0
    scene = scene_of(robot)
    scene.touched()
    assert pick(robot, scene, thing).code == "STALE_POSE"


def test_a_full_hand_does_not_pick(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop()
    thing = robot.detected()
    scene = scene_of(robot)
    robot.gripper_width, robot.gripper_effort = 0.07, 45.0
    scene.update(robot, 0.0)
    scene.grasped(thing, robot.can)
    assert pick(robot, scene, thing).code == "HAND_FULL"


def test_out_of_reach_is_no_grasp(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop((1.2, 0.45))
    result = pick(robot, scene_of(robot), robot.detected())
    assert result.code == "NO_GRASP"
    assert "grasps" in result.failure.message


def test_no_grasp_says_why_each_side_fell_out(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop()
    size = (0.07, 0.11, 0.14)
    seen = robot.detected()
    thing = DetectedObject("packet", seen.pose, size, "box", 0.9, seen.support_height)
    robot.others = [Block((0.3, 0.3, 0.3), (0.75, 0.0, robot.table + 0.35))]
    robot.others += [Block((0.3, 0.06, 0.3), (0.75, y, robot.table + 0.15)) for y in (-0.12, 0.12)]
    result = pick(robot, scene_of(robot), thing)
    assert result.code == "NO_GRASP"
    sides = result.failure.data["sides"]
    assert set(sides) == {"front", "back", "left", "right", "above"}
    assert "110 mm wide" in sides["front"]
    assert "the hand opens to 100 mm" in sides["front"]
    assert "meets what pictures show" in sides["left"] + sides["right"]
    assert all(f"{side}: {reason}" in result.failure.message for side, reason in sides.items())


def test_what_is_too_wide_is_no_grasp(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop()
    thing = robot.detected()
    wide = DetectedObject("box", thing.pose, (0.2, 0.2, 0.13), "box", 0.9, thing.support_height)
    result = pick(robot, scene_of(robot), wide)
    assert result.code == "NO_GRASP"
    assert "100 mm" in result.failure.message


def test_no_way_to_any_grasp_is_no_plan(
    tabletop: type[Tabletop], scene_of: SceneOf, monkeypatch: pytest.MonkeyPatch
) -> None:
    from momantu_skills.manipulation.motion.planner import Planner

    monkeypatch.setattr(Planner, "path", lambda *_: None)
    robot = tabletop()
    assert pick(robot, scene_of(robot), robot.detected()).code == "NO_PLAN"


def test_fingers_that_close_on_nothing_miss(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop()
    thing = robot.detected()
    robot.can, real = None, robot.can
    robot.others = [Block((0.07, 0.07, 0.13), tuple(real.position))]
    result = pick(robot, scene_of(robot), thing)
    assert result.code == "GRASP_MISSED"
    assert robot.gripper_width > 0.09
    distance = np.linalg.norm(robot.odom_from_hand.position - real.position)
    assert distance > 0.08


def test_a_hand_that_meets_something_draws_back_the_way_it_came(
    tabletop: type[Tabletop], scene_of: SceneOf, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where what it met seems to be in every other way."""
    robot, told = tabletop(), list[float]()
    thing = robot.detected()

    def away() -> float:
        return float(np.linalg.norm(robot.odom_from_hand.position - thing.pose.position))

    def met(*_: Any) -> Any:
        return lambda *_: told.append(away()) or away() < 0.08

    monkeypatch.setattr("momantu_skills.pick.bump", met)
    monkeypatch.setattr(Arm, "_way_out", lambda *_: False)
    result = pick(robot, scene_of(robot), thing)
    assert result.code == "GRASP_MISSED"
    assert "before it was around the object" in result.failure.message
    assert min(told) < 0.08
    assert away() == pytest.approx(told[0], abs=0.01)
    assert robot.gripper_width > 0.09


def test_what_stays_behind_has_slipped(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop()
    robot.slips = True
    scene = scene_of(robot)
    assert pick(robot, scene, robot.detected()).code == "SLIPPED"
    assert scene.held is None
    assert robot.gripper_width > 0.09


def test_a_hand_that_gets_no_heavier_holds_nothing(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop()
    robot.weightless = True
    result = pick(robot, scene_of(robot), robot.detected())
    assert result.code == "SLIPPED"
    assert "heavier" in result.failure.message


def test_what_seems_not_to_be_held_is_set_back_and_not_dropped(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop()
    robot.weightless = True
    height, heights = robot.can.position[2], list[float]()
    drop = robot._drop
    robot._drop = lambda: (heights.append(robot.can.position[2]), drop())
    assert pick(robot, scene_of(robot), robot.detected()).code == "SLIPPED"
    assert heights == pytest.approx([height], abs=0.01)


def test_what_still_stands_there_has_slipped(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop()
    x, y, z = robot.can.position
    robot.others = [Block((0.05, 0.05, 0.13), (x, y, z))]
    result = pick(robot, scene_of(robot), robot.detected())
    assert result.code == "SLIPPED"
    assert "still stands" in result.failure.message


@pytest.mark.parametrize("actuator", ["arm", "gripper"])
def test_what_does_not_move_is_stuck(
    tabletop: type[Tabletop], scene_of: SceneOf, actuator: str
) -> None:
    robot = tabletop()
    robot.frozen.add(actuator)
    robot.gripper_width = 0.03
    result = pick(robot, scene_of(robot), robot.detected())
    assert result.code == "ARM_STUCK"
    assert result.duration < 30.0


def test_it_is_held_upright_in_the_pose_for_carrying(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop()
    scene = scene_of(robot)
    assert pick(robot, scene, robot.detected()).status == "SUCCESS"
    robot.joints |= robot.description.named_poses["carry"]
    robot.advance(0.05)
    assert math.acos(robot.can.rotation[2, 2]) < math.radians(20)


def test_success_and_a_missed_grasp_are_about_holding(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop()
    assert pick(robot, scene_of(robot), robot.detected()).claim() == Holding(True)
    robot = tabletop()
    robot.slips = True
    result = pick(robot, scene_of(robot), robot.detected())
    assert (result.code, result.claim()) == ("SLIPPED", Holding(True))


def test_a_full_hand_is_contradicted_by_an_empty_one(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop()
    thing, scene = robot.detected(), scene_of(robot)
    robot.gripper_width, robot.gripper_effort = 0.07, 45.0
    scene.update(robot, 0.0)
    scene.grasped(thing, robot.can)
    assert pick(robot, scene, thing).claim() == Holding(False)


def test_nothing_there_is_contradicted_by_a_thing_there(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop()
    robot.stays_hidden = True
    thing = robot.detected()
    result = pick(robot, scene_of(robot), thing)
    claim = result.claim()
    assert result.code == "NOTHING_THERE"
    assert isinstance(claim, ObjectAt)
    assert claim.asked == ObjectClass("can")
    assert claim.odom_from_object == thing.pose.transform


def test_what_cannot_be_reached_says_nothing_of_the_world(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop((1.2, 0.45))
    assert pick(robot, scene_of(robot), robot.detected()).claim() is None


class OtherScene:
    """A planning scene that keeps the protocol and is of no class that this package has."""

    def __init__(self, scene: Any) -> None:
        self._inner = scene

    def __getattr__(self, name: str) -> Any:
        return getattr(self._inner, name)


def test_any_planning_scene_that_keeps_the_protocol_will_do(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop()
    scene = OtherScene(scene_of(robot))
    result = pick(robot, scene, robot.detected())
    assert result.status == "SUCCESS", result.explain()
    assert scene.held is not None

"""The toolbox: every function does what its page says, and fails with the codes that it names."""

from __future__ import annotations

import dataclasses
import re
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from momantu_skills.manipulation.scene.service import PlanningSceneService
from momantu_skills.toolbox import (
    ARM,
    ARM_FAILURES,
    CAMERA_CARRIER,
    GRIPPER_FAILURES,
    LOOK_FAILURES,
    Arm,
    Contact,
    PlanningScene,
    look_at,
    picture,
)
from momantu_worlds.robots import fetch, kinova_jackal
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.geometry.bodies import Body, Box, Part
from momantu_worlds.testing import plain_episode

from momantu_bt.geometry import Pose, Transform
from momantu_bt.robot import RobotDescription, WristWrench
from momantu_bt.skill import Needs, Run, Skill, compute
from momantu_bt.testing import run_skill
from momantu_bt.testing.painting import Block
from tests.skills.scenery.table import SceneOf, Tabletop

Work = Callable[[Skill, Any, Arm], Run]
SEEN: dict[str, Any] = {}


class Uses(Skill):
    """Use the toolbox as a test says."""

    failures = {**ARM_FAILURES, **GRIPPER_FAILURES, **LOOK_FAILURES}
    uses = {ARM, "gripper", CAMERA_CARRIER}
    planning_scene: PlanningScene = Needs()
    work: Work

    def run(self, robot) -> Run:
        """Do what the test says."""
        SEEN.clear()
        yield from type(self).work(self, robot, Arm(self, robot))


def doing(work: Work) -> type[Uses]:
    return type("Doing", (Uses,), {"__doc__": "Do it.", "work": staticmethod(work)})


@pytest.fixture
def use(tabletop: type[Tabletop], scene_of: SceneOf) -> Callable[..., Any]:
    """`use(work)`: run a skill that does it, with Fetch before a table."""

    def start(work: Work, robot: Tabletop | None = None, **more: Any) -> Any:
        robot = robot or tabletop()
        scene = more.pop("scene", None) or scene_of(robot)
        services = {"planning_scene": scene}
        more.setdefault("map_from_odom", Transform())
        return run_skill(doing(work), robot=robot, services=services, frames=scene.frames, **more)

    return start


READY = (0.62, 0.0, 0.95)
"""Where the hand has room to all sides."""


def at(x: float, y: float, z: float, frame: str = "odom") -> Pose:
    return Pose(Transform((x, y, z)), frame, 0.0)


@pytest.mark.parametrize("frame", ["odom", "map"])
def test_the_hand_goes_to_a_pose(use: Callable[..., Any], frame: str) -> None:
    goal = at(0.65, 0.1, 0.95, frame)

    def work(skill: Skill, robot: Any, arm: Arm) -> Run:
        yield from arm.move_to(goal, "reaching")
        SEEN["hand"] = arm.hand()

    result = use(work)
    assert result.status == "SUCCESS", result.explain()
    assert "reaching" in result.phases
    np.testing.assert_allclose(SEEN["hand"].position, goal.position, atol=2e-3)
    assert SEEN["hand"].transform.angle_to(goal.transform) < 0.02


def test_the_hand_goes_to_a_named_pose_and_to_joints(use: Callable[..., Any]) -> None:
    def work(skill: Skill, robot: Any, arm: Arm) -> Run:
        began = arm.joints
        yield from arm.move_to("home", look=False)
        SEEN["home"] = dict(zip(arm.joint_names, arm.joints, strict=True))
        yield from arm.move_to(began, look=False)
        SEEN["back"] = np.abs(arm.joints - began).max()

    assert use(work).status == "SUCCESS"
    named = fetch().named_poses["home"]
    assert all(abs(SEEN["home"][n] - p) < 0.02 for n, p in named.items() if n in SEEN["home"])
    assert SEEN["back"] < 0.02


def test_inverse_kinematics_solves_what_forward_kinematics_says(use: Callable[..., Any]) -> None:
    goal = at(0.7, -0.1, 0.9)

    def work(skill: Skill, robot: Any, arm: Arm) -> Run:
        SEEN["poses"] = [arm.hand(q) for q in arm.solve(goal)]
        SEEN["far"] = arm.solve(at(3.0, 0.0, 0.9))
        SEEN["free"] = [arm.is_free(q) for q in (arm.joints, arm.solve(at(0.9, 0.0, 0.3))[0])]
        return
        yield ""

    arm_scene = use(work, max_time=1.0)
    assert arm_scene.status == "SUCCESS", arm_scene.explain()
    assert SEEN["poses"]
    assert all(np.allclose(pose.position, goal.position, atol=1e-3) for pose in SEEN["poses"])
    assert SEEN["far"] == []


def test_a_plan_is_followed(use: Callable[..., Any]) -> None:
    def work(skill: Skill, robot: Any, arm: Arm) -> Run:
        way = yield from compute(lambda: arm.plan("carry"), budget=0.4)
        yield from arm.follow(way, "going")

    assert use(work).phases == ("going",)


@pytest.mark.parametrize("by", [(0.1, 0.0, 0.0), (0.0, 0.0, -0.08), (-0.05, 0.05, 0.0)])
def test_a_straight_line_is_straight(use: Callable[..., Any], by: Any) -> None:
    def work(skill: Skill, robot: Any, arm: Arm) -> Run:
        yield from arm.move_to(at(*READY), then=by)
        start = arm.hand().transform
        path = arm.line(by)
        SEEN["local"] = np.array([start.inverse().apply(arm.hand(q).position) for q in path])
        yield from arm.move_straight(by)
        SEEN["end"] = start.inverse().apply(arm.hand().position)

    result = use(work)
    assert result.status == "SUCCESS", result.explain()
    along = SEEN["local"] @ np.array(by) / np.dot(by, by)
    np.testing.assert_allclose(SEEN["local"], along[:, None] * np.array(by), atol=2e-3)
    np.testing.assert_allclose(SEEN["end"], by, atol=5e-3)


def failing(use: Callable[..., Any], work: Work, **more: Any) -> Any:
    return use(work, **more).code


def test_what_cannot_be_reached(use: Callable[..., Any]) -> None:
    def far(skill: Skill, robot: Any, arm: Arm) -> Run:
        yield from arm.move_to(at(3.0, 0.0, 1.0))

    def off(skill: Skill, robot: Any, arm: Arm) -> Run:
        yield from arm.move_to(at(*READY), then=(1.0, 0.0, 0.0))

    def long(skill: Skill, robot: Any, arm: Arm) -> Run:
        yield from arm.move_straight((2.0, 0.0, 0.0))

    assert failing(use, far) == failing(use, long) == failing(use, off) == "NOT_REACHABLE"


def test_no_plan_into_the_table(use: Callable[..., Any]) -> None:
    def work(skill: Skill, robot: Any, arm: Arm) -> Run:
        yield from arm.move_to(at(0.8, 0.0, 0.68))

    assert failing(use, work) in ("NO_PLAN", "NOT_REACHABLE")


def test_no_straight_line_through_something(
    use: Callable[..., Any], tabletop: type[Tabletop]
) -> None:
    tabletop_robot = tabletop()
    x, y, z = READY

    def work(skill: Skill, robot: Any, arm: Arm) -> Run:
        yield from arm.move_to(at(*READY))
        yield from arm.move_straight((0.1, 0.0, 0.0))
        yield from arm.move_straight((-0.1, 0.0, 0.0))
        SEEN["free"] = True
        tabletop_robot.others = [Block((0.06, 0.4, 0.5), (x + 0.12, y, z))]
        yield from look_at(skill, robot, (x + 0.12, y + 0.1, z + 0.2))
        arm.observe()
        yield from arm.move_straight((0.1, 0.0, 0.0))

    assert failing(use, work, robot=tabletop_robot) == "NO_PLAN"
    assert SEEN["free"]


def test_a_held_up_arm_is_stuck(use: Callable[..., Any], tabletop: type[Tabletop]) -> None:
    held_up = tabletop()

    def work(skill: Skill, robot: Any, arm: Arm) -> Run:
        yield from arm.move_to(at(*READY))
        held_up.frozen = {"arm"}
        yield from arm.move_straight((0.1, 0.0, 0.0))

    assert failing(use, work, robot=held_up) == "ARM_STUCK"


def test_the_gripper_opens_closes_and_can_be_stuck(
    use: Callable[..., Any], tabletop: type[Tabletop]
) -> None:
    def work(skill: Skill, robot: Any, arm: Arm) -> Run:
        SEEN["closed"] = yield from arm.close_gripper(0.02)
        yield from arm.open_gripper(0.06)
        SEEN["open"] = robot.state().gripper_width

    assert use(work).status == "SUCCESS"
    assert abs(SEEN["closed"] - 0.02) < 0.01
    assert abs(SEEN["open"] - 0.06) < 0.01
    robot = tabletop()
    robot.gripper_width = 0.0
    robot.frozen = {"gripper"}

    def opening(skill: Skill, robot: Any, arm: Arm) -> Run:
        yield from arm.open_gripper()

    assert failing(use, opening, robot=robot) == "GRIPPER_STUCK"


def test_the_camera_looks_at_poses_and_points(use: Callable[..., Any]) -> None:
    def work(skill: Skill, robot: Any, arm: Arm) -> Run:
        yield from look_at(skill, robot, (0.8, 0.2, 0.72))
        SEEN["off"] = picture(skill, robot).odom_from_camera.inverse().apply((0.8, 0.2, 0.72))
        yield from look_at(skill, robot, at(0.8, -0.2, 0.72, "map"))

    result = use(work)
    assert result.status == "SUCCESS", result.explain()
    assert np.hypot(*SEEN["off"][:2]) / SEEN["off"][2] < 0.1

    def behind(skill: Skill, robot: Any, arm: Arm) -> Run:
        yield from look_at(skill, robot, (-3.0, 0.0, 0.5))

    assert failing(use, behind) == "OUT_OF_VIEW"


def test_what_an_author_got_wrong_says_what_to_do(use: Callable[..., Any]) -> None:
    class Bare(Skill):
        """Have no planning scene."""

        uses = {ARM}

        def run(self, robot) -> Run:
            """Want the arm all the same."""
            Arm(self, robot)
            yield ""

    assert "declare `planning_scene" in run_skill(Bare).failure.message

    def unknown(skill: Skill, robot: Any, arm: Arm) -> Run:
        yield from arm.move_to("hone")

    def weak(skill: Skill, robot: Any, arm: Arm) -> Run:
        yield from arm.move_until_force((0.1, 0.0, 0.0), 0.5)

    assert "did you mean home?" in use(unknown).failure.message
    assert "expected at least 3 N" in use(weak).failure.message


# A stiff post, in physics.


class Pushed:
    """A world: a robot before a post that does not give way. peak: greatest true force on it, N."""

    def __init__(self, description: RobotDescription, x: float, z: float) -> None:
        post = Body("post", "post", Transform((x, 0.0, z / 2 + 0.2)), (POST,))
        episode = plain_episode(table=False)
        episode = dataclasses.replace(episode, bodies=(*episode.bodies, post))
        pose = description.named_poses["ready"]
        self.simulator = Simulator(description, episode, 0, pose=pose)
        self.simulator.truth.watch_contacts()
        self.site, self.name, self.peak, self.now_felt = episode.site, "pushed", 0.0, 0.0

    @property
    def robot(self) -> Any:
        return self.simulator.robot

    def now(self) -> float:
        return self.simulator.now()

    def step(self) -> None:
        self.simulator.step()
        contacts = self.simulator.truth.contacts()
        self.now_felt = sum(c.force for c in contacts if "post" in (c.first, c.second))
        self.peak = max(self.peak, self.now_felt)


POST = Part(Box((0.1, 0.3, 1.4)))


def push(description: RobotDescription, hand: Pose, **options: Any) -> tuple[Pushed, Any]:
    """The hand moves to a pose 6 cm before the post, then on until 8 N."""
    world = Pushed(description, float(hand.position[0]) + 0.14, float(hand.position[2]))

    def work(skill: Skill, robot: Any, arm: Arm) -> Run:
        yield from arm.close_gripper()
        yield from arm.move_to(hand, then=(0.11, 0.0, 0.0))
        SEEN["contact"] = yield from arm.move_until_force((0.11, 0.0, 0.0), 8.0, **options)
        yield "resting"
        SEEN["rest"] = world.now_felt
        yield from arm.retreat(0.05)
        SEEN["after"] = world.now_felt

    services: Mapping[str, Any] = {"planning_scene": PlanningSceneService()}
    try:
        return world, run_skill(doing(work), world=world, services=services)  # type: ignore[arg-type]
    finally:
        world.simulator.close()


def without_wrench(description: RobotDescription) -> RobotDescription:
    kept = {n: s for n, s in description.sensors.items() if not isinstance(s, WristWrench)}
    return description.model_copy(update={"sensors": kept})


HANDS = {"fetch": (fetch, at(0.66, 0.0, 0.85)), "kinova": (kinova_jackal, at(0.55, 0.0, 0.75))}


@pytest.mark.parametrize("name", HANDS)
def test_a_contact_is_felt_measured_and_bounded(name: str) -> None:
    robot, hand = HANDS[name]
    world, result = push(robot(), hand)
    assert result.status == "SUCCESS", result.explain()
    contact: Contact = SEEN["contact"]
    assert contact.felt
    assert 8.0 < world.peak < 80.0
    assert contact.strength == pytest.approx(world.peak, rel=0.2)
    assert contact.force[0] < -0.9 * contact.strength  # the post pushes back
    assert SEEN["rest"] < 8.0
    assert SEEN["after"] == 0.0


def test_a_robot_without_a_wrist_sensor_feels_with_its_motors() -> None:
    robot, hand = HANDS["fetch"]
    world, result = push(without_wrench(robot()), hand)
    assert result.status == "SUCCESS", result.explain()
    assert SEEN["contact"].felt
    assert world.peak < 80.0


def test_nothing_there_is_no_contact(use: Callable[..., Any]) -> None:
    def work(skill: Skill, robot: Any, arm: Arm) -> Run:
        SEEN["contact"] = yield from arm.move_until_force((0.05, 0.0, 0.0), 5.0, speed=0.05)

    result = use(work)
    assert result.status == "SUCCESS", result.explain()
    assert not SEEN["contact"].felt
    assert SEEN["contact"].travel == pytest.approx(0.05, abs=0.005)


def test_the_example_of_the_page_waves(
    tabletop: type[Tabletop], scene_of: SceneOf, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = (Path(__file__).parents[2] / "docs" / "toolbox.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    page = ModuleType("toolbox_page")
    monkeypatch.setitem(sys.modules, page.__name__, page)
    exec(block, page.__dict__)
    robot = tabletop()
    scene = scene_of(robot)
    services = {"planning_scene": scene}
    result = run_skill(page.Wave, robot=robot, services=services, frames=scene.frames)
    assert result.status == "SUCCESS", result.explain()
    assert result.phases[-1] == "waving"

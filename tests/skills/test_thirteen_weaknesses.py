"""The weaknesses of the tutorial that this project replaces; each test shows that one is not ours.

What a skill's own tests prove in depth is shown here once, in the order of the list.
"""

from __future__ import annotations

import ast
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

import momantu_skills
import numpy as np
import pytest
from momantu_skills.check import Check
from momantu_skills.detect_object import DetectObject
from momantu_skills.detect_plane import DetectPlane
from momantu_skills.manipulation.hand.grasps import grasps_for
from momantu_skills.pick import Pick
from momantu_skills.reset_pose import ResetPose

from momantu_bt import run
from momantu_bt.frames import FrameBuffer
from momantu_bt.geometry import Pose, Transform
from momantu_bt.messages import ObjectClass, SupportPlane
from momantu_bt.skill import Skill
from momantu_bt.testing import ScriptedRobot, ScriptedWorld, run_skill
from momantu_bt.testing.painting import Block, Round
from momantu_bt.tree.load import load
from momantu_bt.tree.registry import Registry
from momantu_bt.world import TICK
from tests.skills.scenery.onlooker import Onlooker, SeenScene
from tests.skills.scenery.table import SceneOf, Tabletop

TREE = Path(__file__).resolve().parents[2] / "trees" / "bring_object.yaml"


def lost(frame: str) -> Pose:
    return Pose(Transform((1.0, 0.0, 0.7)), frame, 0.0)


def test_1_no_endless_wait_for_a_transform(onlooker: Onlooker, seen_scene: type[SeenScene]) -> None:
    robot = onlooker([])
    services = {"planning_scene": seen_scene()}
    result = run_skill(
        DetectPlane, robot=robot, inputs={"near": lost("nowhere")}, services=services
    )
    assert result.code == "FRAME_UNKNOWN"
    assert result.duration <= TICK


@pytest.mark.parametrize("ticks", [1, 8, 20, 40])
def test_2_what_runs_can_be_pre_empted(
    tabletop: type[Tabletop], scene_of: SceneOf, ticks: int
) -> None:
    robot = tabletop()
    scene = scene_of(robot)
    result = run_skill(
        ResetPose, robot=robot, inputs={"pose": "carry"}, services={"planning_scene": scene},
        frames=scene.frames, max_time=ticks * TICK,
    )  # fmt: skip
    assert result.status == "HALTED"
    for _ in range(10):
        robot.advance(TICK)
    before = dict(robot.joints)
    robot.advance(TICK)
    assert robot.joints == before


def test_3_no_failure_sticks(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop()
    scene = scene_of(robot)
    thing, robot.can = robot.detected(), None
    inputs, services = {"object": thing}, {"planning_scene": scene}
    missed = run_skill(Pick, robot=robot, inputs=inputs, services=services, frames=scene.frames)
    assert missed.status == "FAILURE"
    robot.can = thing.pose.transform
    again = {"object": robot.detected()}
    result = run_skill(Pick, robot=robot, inputs=again, services=services, frames=scene.frames)
    assert result.status == "SUCCESS", result.explain()


def test_4_no_success_without_a_transform() -> None:
    class Lost:
        """A localization that has never spoken: nobody knows where odom lies in the map."""

        quality = 1.0
        covariance = np.zeros((3, 3))

        @property
        def map_from_base(self) -> Any:
            raise AssertionError("nobody may ask for a pose that is not known")

    robot = ScriptedRobot()
    result = run_skill(
        DetectObject,
        robot=robot,
        inputs={"object": ObjectClass("can"), "on": "table_a"},
        services={"localization": Lost(), "planning_scene": None},
        frames=_frames_without_map(robot),
    )
    assert result.code == "FRAME_UNKNOWN"


def _frames_without_map(robot: ScriptedRobot) -> FrameBuffer:
    frames = FrameBuffer(robot.description.kinematics())
    frames.add_state(robot.state())
    return frames


def test_5_a_plane_that_is_not_there_is_not_detected(
    onlooker: Onlooker, seen_scene: type[SeenScene]
) -> None:
    near = Pose(Transform((0.95, 0.1, 0.5)), "odom", 0.0)
    inputs = {"near": near, "size": (0.07, 0.07, 0.13)}
    services = {"planning_scene": seen_scene()}
    table = Block((0.6, 1.2, 0.03), (1.0, 0.0, 0.485))
    there = run_skill(DetectPlane, robot=onlooker([table]), inputs=inputs, services=services)
    gone = run_skill(DetectPlane, robot=onlooker([]), inputs=inputs, services=services)
    assert there.status == "SUCCESS", there.explain()
    assert there.outputs["plane"].pose.position[2] == pytest.approx(0.5, abs=0.01)
    assert gone.code == "PLANE_NOT_FOUND"


@pytest.mark.parametrize(("height", "radius"), [(0.10, 0.03), (0.13, 0.035), (0.18, 0.04)])
def test_6_the_size_is_measured(
    onlooker: Onlooker, seen_scene: type[SeenScene], height: float, radius: float
) -> None:
    table = Block((0.8, 1.2, 0.03), (2.0, 0.0, 0.685))
    robot = onlooker([table, Round((1.75, 0.1, 0.7), height, radius)])
    robot.base = type(robot.base)(0.8, 0.0, 0.0)
    result = run_skill(
        DetectObject, robot=robot, inputs={"object": ObjectClass("can"), "on": "table_a"},
        services={"localization": None, "planning_scene": seen_scene()}, map_from_odom=Transform(),
    )  # fmt: skip
    assert result.status == "SUCCESS", result.explain()
    size = result.outputs["found"].size
    assert size == pytest.approx((2 * radius, 2 * radius, height), abs=0.008)


def test_7_there_are_many_grasps(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop()
    scene = scene_of(robot)
    hand = robot.description.end_effector
    found = grasps_for(robot.detected(), hand, scene.scene.model.hulls[hand.frame])
    ways = {tuple(np.round(g.object_from_grasp.rotation[:, 0], 1)) for g in found}
    assert len(ways) > 20


def test_8_a_pick_without_a_can_is_no_success(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop()
    robot.slips = True
    scene = scene_of(robot)
    result = run_skill(
        Pick, robot=robot, inputs={"object": robot.detected()},
        services={"planning_scene": scene}, frames=scene.frames,
    )  # fmt: skip
    assert result.code == "SLIPPED"


def test_9_a_failed_pick_leaves_no_constraint(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop()
    robot.slips = True
    scene = scene_of(robot)
    services = {"planning_scene": scene}
    inputs = {"object": robot.detected()}
    assert run_skill(
        Pick, robot=robot, inputs=inputs, services=services, frames=scene.frames
    ).failure
    scene.update(robot, robot.time)
    assert scene.held is None
    result = run_skill(
        ResetPose, robot=robot, inputs={"pose": "home"}, services=services, frames=scene.frames
    )
    assert result.status == "SUCCESS", result.explain()


def test_10_an_old_detection_is_refused(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop()
    scene = scene_of(robot)
    old = robot.detected(stamp=robot.time - 300.0)
    result = run_skill(
        Pick, robot=robot, inputs={"object": old}, services={"planning_scene": scene},
        frames=scene.frames,
    )  # fmt: skip
    assert result.code == "STALE_POSE"
    assert all(actuator != "arm" for _, actuator, _ in robot.commands)


def test_11_the_tree_checks_where_it_is_looks_again_and_goes_home() -> None:
    document = load(str(TREE)).document
    nodes = [node for tree in document.trees.values() for node in tree.root.walk()]
    kinds = [node.type for node in nodes]
    assert "relocalize" in kinds
    assert kinds.count("detect_object") >= 2
    main = document.trees[document.main].root
    assert main.children[-1].target == "Fold"

    class Unsure:
        """A localization that does not know where it is."""

        quality = 0.05
        covariance = np.eye(3)
        map_from_base = None

    result = run_skill(Check, inputs={"what": "localized"}, services=_both(Unsure()))
    assert result.code == "NOT_LOCALIZED"


def _both(localization: Any) -> dict[str, Any]:
    return {"localization": localization, "planning_scene": None}


def test_12_nothing_sleeps_while_all_goes_well(tabletop: type[Tabletop]) -> None:
    installed = Registry.installed()
    pose = Pose(Transform((1.0, 0.0, 0.8)), "odom", 0.0)
    plane = SupportPlane(pose, ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)))
    outputs = {
        "found": tabletop().detected(),
        "tag_pose": pose,
        "tag_sigma": 0.001,
        "tag_covariance": (0.0,) * 36,
        "plane": plane,
        "spots": (pose,),
    }

    def instant(name: str) -> type[Skill]:
        real = installed.skills[name]

        def work(self: Skill, robot: Any) -> Any:
            for port in real.ports.values():
                if port.direction == "out":
                    setattr(self, port.name, outputs[port.name])
            yield from ()

        return type(real.__name__, (real,), {"run": work, "needs": (), "__doc__": real.__doc__})

    skills = {name: instant(name) for name in installed.skills}
    registry = Registry(skills, {}, {}, dict.fromkeys(installed.services))
    report = run(TREE, world=ScriptedWorld(), registry=registry)
    assert report.status == "SUCCESS", report.failure
    assert report.sim_time_s < 1.0


def test_13_every_module_of_the_skills_is_used_by_a_test() -> None:
    folder = Path(momantu_skills.__file__).parent
    tests = Path(__file__).parent
    imported: set[str] = set()
    for source in [*tests.rglob("*.py"), *folder.rglob("*.py")]:
        for node in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module:
                imported |= {node.module, *(f"{node.module}.{a.name}" for a in node.names)}
    imported |= {verb.module for verb in entry_points(group="momantu_bt.commands")}
    skills = [
        path.stem for path in folder.glob("*.py") if (tests / f"test_{path.stem}.py").exists()
    ]
    assert len(skills) == 27, "twenty-six skills and the toolbox"
    for path in folder.rglob("*.py"):
        name = ".".join(path.relative_to(folder.parent).with_suffix("").parts)
        if path.stem not in ("__init__", "__main__", "diagnosis", "warm_up"):
            assert name in imported, name

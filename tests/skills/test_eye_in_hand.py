"""The skills on a robot that has no head and no wrench: it looks, grasps and sets down by arm."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from momantu_skills.detect_object import DetectObject
from momantu_skills.detect_plane import DetectPlane
from momantu_skills.pick import Pick
from momantu_skills.place import Place
from momantu_skills.reset_pose import ResetPose

from momantu_bt.geometry import Pose, Pose2D, Transform
from momantu_bt.messages import ObjectClass
from momantu_bt.testing import eye_in_hand_robot, run_skill, scripted_site
from momantu_bt.world import Surface
from tests.skills.scenery.table import SceneOf, Tabletop

TABLE = Surface(Pose2D(0.9, 0.0, 0.0), (0.8, 1.4), 0.72, (math.pi,))
CAN = ObjectClass("can")


@pytest.fixture
def before_table(tabletop: type[Tabletop], scene_of: SceneOf) -> Any:
    """`before_table(can)`: the robot, and `run(skill, **inputs)` that shares all it knows."""

    def build(can: tuple[float, float]) -> Any:
        robot = tabletop(can=can, pose="home", description=eye_in_hand_robot())
        scene = scene_of(robot)
        scene.frames.set_map_from_odom(Transform(), 0.0)
        services = {"planning_scene": scene, "localization": object()}

        def run(skill: Any, **inputs: Any) -> Any:
            site = scripted_site(surfaces={"table": TABLE})
            return run_skill(
                skill,
                robot=robot,
                inputs=inputs,
                services=services,
                site=site,
                frames=scene.frames,
                on_tick=lambda session, world: scene.update(robot, robot.time),
            )

        return robot, scene, run

    return build


def test_a_can_is_found_taken_and_set_down_elsewhere(before_table: Any) -> None:
    can = (0.70, -0.20)
    robot, scene, run = before_table(can)
    found = run(DetectObject, object=CAN, on="table")
    assert found.status == "SUCCESS", found.explain()
    thing = found.outputs["found"]
    assert np.linalg.norm(thing.pose.position[:2] - can) < 0.01

    assert run(ResetPose, pose="ready").status == "SUCCESS"
    taken = run(Pick, object=run(DetectObject, object=CAN, on="table").outputs["found"])
    assert taken.status == "SUCCESS", taken.explain()
    assert scene.held is not None
    camera = scene.scene.model.grasp_from_camera
    above = scene.held.grasp_from_object.inverse() @ camera
    assert above.position[2] > scene.held.grasp_from_object.inverse().position[2]

    assert run(ResetPose, pose="carry").status == "SUCCESS"
    near = Pose(Transform((0.75, 0.3, 0.72)), "odom", robot.time)
    top = run(DetectPlane, near=near)
    assert top.status == "SUCCESS", top.explain()
    assert top.outputs["plane"].pose.position[2] == pytest.approx(0.72, abs=0.01)

    placed = run(Place, plane=top.outputs["plane"], spots=top.outputs["spots"])
    assert placed.status == "SUCCESS", placed.explain()
    assert scene.held is None
    assert np.linalg.norm(robot.can.position[:2] - (0.75, 0.3)) < 0.35
    assert robot.can.rotation[2, 2] > math.cos(math.radians(3))


def test_nothing_stands_there_is_said_after_looking_from_several_sides(before_table: Any) -> None:
    robot, _, run = before_table((0.75, 0.0))
    robot.can = None
    result = run(DetectObject, object=CAN, on="table")
    assert result.code == "OBJECT_NOT_FOUND"
    assert "nothing stands there" in result.explain()
